"""Load flows and states of a response over time, ready to be drawn."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from modelpages.chart import Line, Panel

from divideropt.models.base import FloatArray
from divideropt.models.divider.response import Phase, Response
from thesisfigures.thin import thinned

SAMPLES = 3000
"""Instants of a phase, before those that do not show are left out."""

TIME = "time after the step [s]"
"""What stands under such a panel."""

FLOW_FACTOR, FLOW_UNIT = 1e4, "10⁻⁴ m³/s"
"""The author's unit of load flows, changeall.m."""


@dataclass(frozen=True)
class TimeCourse:
    """A response at instants.

    Attributes:
        times: After the last event begins [s], shape (n,); where the load steps, twice the same.
        states: Shape (n, 9).
        flows: QL1 and QL2 [m^3/s], shape (n, 2).
    """

    times: FloatArray
    states: FloatArray
    flows: FloatArray


def course_between(response: Response, begin: float, end: float) -> TimeCourse:
    """Sample a response, as far as it came; at rest before an event where it began settled.

    Args:
        response: The response.
        begin: First instant after the last event [s], negative before it.
        end: Last instant [s].
    """
    step = response.scenario.last_event_time
    times, states, flows = [np.empty(0)], [np.empty((0, 9))], [np.empty((0, 2))]
    for phase in response.phases:
        at, there = _sampled(phase, begin + step, end + step)
        if len(at):
            times.append(at - step)
            states.append(there)
            flows.append(phase.load_flows(there, at))
    return TimeCourse(np.concatenate(times), np.concatenate(states), np.concatenate(flows))


def _sampled(phase: Phase, begin: float, end: float) -> tuple[FloatArray, FloatArray]:
    if phase.trajectory is None:
        if phase.end is None:
            return np.empty(0), np.empty((0, 9))
        at = np.array([begin, phase.span.end])
        return at, np.stack([phase.end, phase.end])
    edges = phase.trajectory.edges
    low, high = max(begin, float(edges[0])), min(end, float(edges[-1]))
    if high <= low:
        return np.empty(0), np.empty((0, 9))
    at = np.linspace(low, high, SAMPLES)
    return at, phase.trajectory.at(at)


def panel_over(lines: Sequence[Line], y_label: str, title: str, window: tuple[float, float]) -> Panel:
    """Return a panel over a stretch of time, its ordinate wide enough for every line.

    Args:
        lines: What is drawn, sampled in the window.
        y_label: Of the ordinate.
        title: Above it.
        window: First and last instant after the step [s].
    """
    low, high = (limit(float(limit(line.y)) for line in lines if len(line.y)) for limit in (min, max))
    margin = 0.05 * (high - low)
    extent = (low - margin, high + margin)
    return Panel([thin_line(line, window, extent) for line in lines], TIME, y_label, title, window, extent)


def thin_line(line: Line, x_range: tuple[float, float], y_range: tuple[float, float]) -> Line:
    """Return a line with no more points than show on such axes."""
    if len(line.x) < 2:
        return line
    x, y = thinned(line.x, line.y, x_range, y_range)
    return Line(line.label, x, y, line.colour, line.dash, line.width)
