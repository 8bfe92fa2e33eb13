"""A response in arrays: the form in which compiled functions measure and judge it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray
from divideropt.models.divider.coefficients import rules_record, span_records
from divideropt.models.divider.record import COEFFICIENTS, GEOMETRY, PARAMETER_ROW, Records, blank
from divideropt.models.divider.response import Response
from divideropt.models.divider.states import N_STATES
from divideropt.ode import SolverStatus
from divideropt.ode.base import NODES_PER_STEP

IntArray = NDArray[np.int64]


class Course(NamedTuple):
    """A response of p phases and s steps in all.

    Attributes:
        row: `PARAMETER_ROW`, shape (1,).
        derived: `GEOMETRY`, shape (1,).
        rules: `RULES` of the scenario, shape (1,).
        spans: `SPAN` of the phases, shape (p,).
        designs: `COEFFICIENTS` in force, shape (p,).
        first: Steps before each phase, and in all, shape (p + 1,).
        edges: Times of the steps [s], shape (s + 1,) or longer; phases follow each other without a gap.
        values: States at the nodes of each step, shape (s, 9, NODES_PER_STEP) or longer.
        flows: Room for QL1 and QL2 there, shape (s, 2, NODES_PER_STEP) or longer; `measure_course` fills it.
        stopped: Whether the solver gave up in it, shape (p,).
        reached: Whether its end was reached, shape (p,).
        ends: States at the ends, shape (p, 9).
        rested: Whether an equilibrium is known, shape (p,).
        rests: The equilibria, shape (p, 9).
        banded: Whether those with Coulomb friction to one side and the other are known, shape (p,).
        bands: Those, shape (p, 2, 9).
    """

    row: Records
    derived: Records
    rules: Records
    spans: Records
    designs: Records
    first: IntArray
    edges: FloatArray
    values: FloatArray
    flows: FloatArray
    stopped: IntArray
    reached: IntArray
    ends: FloatArray
    rested: IntArray
    rests: FloatArray
    banded: IntArray
    bands: FloatArray


def empty_course(rules: Records, spans: Records, steps: int) -> Course:
    """Return a course with room for so many steps; memory that is not reached is not touched.

    Args:
        rules: `RULES` of a scenario, shape (1,).
        spans: `SPAN` of its stretches, shape (p,).
        steps: How many.
    """
    p = len(spans)
    return Course(
        row=blank(PARAMETER_ROW),
        derived=blank(GEOMETRY),
        rules=rules,
        spans=spans,
        designs=blank(COEFFICIENTS, p),
        first=np.zeros(p + 1, dtype=np.int64),
        edges=np.empty(steps + 2),
        values=np.empty((steps, N_STATES, NODES_PER_STEP)),
        flows=np.empty((steps, 2, NODES_PER_STEP)),
        stopped=np.zeros(p, dtype=np.int64),
        reached=np.zeros(p, dtype=np.int64),
        ends=np.zeros((p, N_STATES)),
        rested=np.zeros(p, dtype=np.int64),
        rests=np.zeros((p, N_STATES)),
        banded=np.zeros(p, dtype=np.int64),
        bands=np.zeros((p, 2, N_STATES)),
    )


def course_of(response: Response) -> Course:
    """Pack a response."""
    runs = [phase.trajectory for phase in response.phases]
    rules, spans = rules_record(response.scenario), span_records(response.scenario.spans())
    course = empty_course(rules, spans, sum(0 if run is None else len(run.values) for run in runs))
    course.row[:], course.derived[:] = response.valve.row, response.valve.derived
    for i, phase in enumerate(response.phases):
        course.designs[i] = phase.design[0]
        begin = course.first[i]
        course.first[i + 1] = begin
        if phase.trajectory is not None:
            after = begin + len(phase.trajectory.values)
            course.first[i + 1] = after
            course.edges[begin : after + 1] = phase.trajectory.edges
            course.values[begin:after] = phase.trajectory.values
            course.stopped[i] = phase.trajectory.status is not SolverStatus.FINISHED
        if phase.end is not None:
            course.reached[i], course.ends[i] = 1, phase.end
        if phase.rest is not None:
            course.rested[i], course.rests[i] = 1, phase.rest.state
        band = response.friction_band(phase)
        if band is not None:
            course.banded[i], course.bands[i] = 1, band
    return course
