"""Step responses for the report: of the thesis's three sets, and of the designs that it shows closely."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from divideropt.campaign.plan import dividers
from divideropt.models.base import FloatArray
from divideropt.models.divider import PARAMETER_SETS, Divider, parameter_set
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.response import Phase, Response
from divideropt.models.divider.scenarios import BASE
from divideropt.ode import SolverStatus
from divideropt.problem import Problem, one_thread
from divideropt.report.display import rounded
from divideropt.report.front import Design
from divideropt.report.sampling import thin

MOST_POINTS = 150
"""Points of a response."""

LEAD_POINTS = 30
"""Points of the time before the step."""

LEAD = 0.02
"""Time before the step that is drawn, as a share of the time after it."""

POINTS_PER_STEP = 30
"""Candidates for points in each step of the solver."""

FINE = 2e-4
"""Deviation from the curve, in shares of its size, that nobody sees: less than a tenth of a pixel."""

SETTLED = 5e-3
"""Band around the final flows, in shares of them, within which nothing more is to be seen."""

_MS, _LITRES_PER_MINUTE = 1e3, 6e4


@dataclass(frozen=True)
class StepResponse:
    """The load flows of one design over the events.

    Attributes:
        name: The design's id, or the name of a parameter set.
        times: Since the first event [ms].
        flows: QL1 and QL2 [L/min], each as long as `times`.
        busy: When both flows are within `SETTLED` of their final values for good [ms].
    """

    name: str
    times: tuple[float, ...]
    flows: tuple[tuple[float, ...], tuple[float, ...]]
    busy: float


@dataclass(frozen=True)
class Responses:
    """What the report's section of step responses shows.

    Attributes:
        sets: Of the thesis's parameter sets.
        designs: Of the chosen designs, in the order in which they are offered.
        notes: Sentences on what is not shown, or not to be taken at face value.
    """

    sets: tuple[StepResponse, ...]
    designs: tuple[StepResponse, ...]
    notes: tuple[str, ...]


def read_responses(problem: Problem, designs: Sequence[Design]) -> Responses | None:
    """Simulate the responses.

    Args:
        problem: What was optimised.
        designs: Those to show.

    Returns:
        The responses, or None where the model is not the divider and has none.
    """
    model = dividers(problem.model).get(BASE)
    if model is None:
        return None
    with one_thread():  # as the runs were simulated, so that a response ends as its design did
        return _simulated(model, problem, designs)


def step_response(
    name: str, response: Response, lead: float = LEAD, lead_points: int = LEAD_POINTS, points: int = MOST_POINTS
) -> StepResponse | None:
    """Reduce a response to what is drawn.

    Args:
        name: Whose it is.
        response: As simulated.
        lead: How much of the time before the first event, as a share of the time after it.
        lead_points: Most points of that, where something moves there.
        points: Most points of each phase after it.

    Returns:
        The load flows; None where the simulation did not get to the end.
    """
    first, *later = response.phases
    if any(p.trajectory is None or p.trajectory.status is not SolverStatus.FINISHED for p in later):
        return None
    begin = response.scenario.events[0].at
    before = _before(first, begin, lead * (response.scenario.end_time - begin), lead_points)
    parts = [_sampled(phase, phase.span.begin, phase.span.end, points) for phase in later]
    after = np.concatenate([times for times, _ in parts]) - begin, np.concatenate([flows for _, flows in parts])
    times = np.concatenate([before[0] - begin, after[0]])
    flows = np.concatenate([before[1], after[1]])
    return StepResponse(
        name,
        tuple(rounded(t * _MS) for t in times),
        (_flows(flows[:, 0]), _flows(flows[:, 1])),
        rounded(_busy(*after) * _MS),
    )


def _simulated(model: Divider, problem: Problem, designs: Sequence[Design]) -> Responses:
    sets, notes = [], []
    for name in PARAMETER_SETS:
        response = model.respond(parameter_set(name))
        verdict = measure(response)[1]
        curve = step_response(name, response)
        if curve is not None:
            sets.append(curve)
        if not verdict.ok:
            shown = "as far as it goes" if curve is not None else "so it is not drawn"
            notes.append(f"{name} under this scenario ends {verdict.outcome} ({verdict.text}); {shown}.")
    curves = [(d, step_response(d.design_id, model.respond(_parameters(problem, d)))) for d in designs]
    failed = [design.design_id for design, curve in curves if curve is None]
    if failed:
        notes.append(f"These designs did not complete when simulated again: {', '.join(failed)}.")
    return Responses(tuple(sets), tuple(c for _, c in curves if c is not None), tuple(notes))


def _parameters(problem: Problem, design: Design) -> Mapping[str, float]:
    return dict(problem.fixed) | dict(zip(problem.space.names, design.variables, strict=True))


def _before(phase: Phase, step: float, lead: float, count: int) -> tuple[FloatArray, FloatArray]:
    """Times and flows before the first event: at rest, or the end of the way there."""
    if phase.trajectory is not None:
        return _sampled(phase, max(step - lead, float(phase.trajectory.edges[0])), step, count)
    if phase.end is None:
        return np.empty(0), np.empty((0, 2))
    return np.array([step - lead, step]), np.tile(phase.load_flows(phase.end), (2, 1))


def _sampled(phase: Phase, begin: float, end: float, count: int) -> tuple[FloatArray, FloatArray]:
    """Times and flows at the points that keep the curves' shape."""
    assert phase.trajectory is not None
    edges = phase.trajectory.edges
    edges = np.unique(np.concatenate([[begin], edges[(edges > begin) & (edges < end)], [end]]))
    shares = np.arange(POINTS_PER_STEP) / POINTS_PER_STEP
    times = np.append((edges[:-1, None] + shares * np.diff(edges)[:, None]).ravel(), edges[-1])
    flows = phase.load_flows(phase.trajectory.at(times), times)
    size = np.abs(flows).max(axis=0)
    kept = thin(times, flows / np.where(size > 0.0, size, 1.0), count, FINE)
    return times[kept], flows[kept]


def _flows(column: FloatArray) -> tuple[float, ...]:
    return tuple(rounded(q * _LITRES_PER_MINUTE) for q in column)


def _busy(times: FloatArray, flows: FloatArray) -> float:
    outside = np.flatnonzero((np.abs(flows - flows[-1]) > SETTLED * np.abs(flows[-1])).any(axis=1))
    return float(times[min(outside[-1] + 1, len(times) - 1)]) if len(outside) else float(times[0])
