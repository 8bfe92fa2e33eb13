"""Figures 4.4, 4.5 and 4.8: what was measured, simulated with the prototype in the rig as assumed."""

from dataclasses import replace

import numpy as np
from claims.experiment import ASSUMED, CENTRED, Assumptions, respond_in_rig
from claims.judgement import Answer, Judgement
from claims.resolution import steady_bias
from claims.trends import FIRST_TEST, POSITIONS, Trend, run_tests
from modelpages.chart import Line, draw

from divideropt.models.base import FloatArray, Outcome
from divideropt.models.divider import rig
from thesisfigures.courses import FLOW_FACTOR, FLOW_UNIT, TimeCourse, course_between, panel_over
from thesisfigures.figure import Both
from thesisfigures.statements import IN_RIG

MEASURED_ERROR = 1.23
"""Steady-state error of the test [%], section 4.3."""

VOLUMES = (ASSUMED, replace(ASSUMED, name="volumes × 100", volumes=100.0))
"""As assumed, and the slowest of what was tried: the volumes of the rig are not stated."""

WINDOW = (-0.1, 0.4)
"""What they are drawn over, after the step [s]."""

CLOSED, HALF_CLOSED = 0.1, 0.5
"""Flows have converged whose gap is this part of the largest after the step; by the second in part."""

PRESSURES = ((0, "Ps"), (1, "Pa1"), (2, "Pa2"))
"""States of Figure 4.5."""


def draw_first_test(_: Both) -> str:
    """Draw the twin of Figure 4.4: the load flows."""
    panels = []
    for case in VOLUMES:
        lines = []
        for name, dash in zip(IN_RIG, ("solid", "dash"), strict=True):
            course = _first_test(name, case, WINDOW)
            lines += _flow_lines(course, tuple(f"{flow}, {name}" for flow in ("QL1", "QL2")), dash)
        panels.append(panel_over(lines, f"load flow [{FLOW_UNIT}]", case.name, WINDOW))
    return draw(panels, "Load flows of the prototype in the rig after load 1 drops by 1.64 MPa")


def draw_pressures(_: Both) -> str:
    """Draw the twin of Figure 4.5: source, chamber and load difference pressures."""
    panels = []
    for name in IN_RIG:
        course = _first_test(name, ASSUMED, WINDOW)
        lines = [Line(label, course.times, course.states[:, i] * 1e-6, k) for k, (i, label) in enumerate(PRESSURES)]
        lines.append(Line("ΔPL = PL2 − PL1", course.times, _load_difference(course) * 1e-6, 3, "dash"))
        panels.append(panel_over(lines, "pressure [MPa]", name, WINDOW))
    return draw(panels, "Pressures of the prototype in the rig after load 1 drops by 1.64 MPa")


def draw_rotated(_: Both) -> str:
    """Draw the twin of Figure 4.8: the load flows with the spool centred and turned."""
    panels = []
    for name in IN_RIG:
        lines = []
        for position, dash in ((CENTRED, "solid"), (POSITIONS[0], "dash")):
            response = respond_in_rig(name, ASSUMED, rig.ROTATION_FIXED_DROP, rig.ROTATION_LOAD_DIFFERENCE, position)
            labels = tuple(f"{flow}, φ/φ₀ = {position:g}" for flow in ("QL1", "QL2"))
            lines += _flow_lines(course_between(response, *WINDOW), labels, dash)
        panels.append(panel_over(lines, f"load flow [{FLOW_UNIT}]", name, WINDOW))
    return draw(panels, "Load flows of the prototype in the rig, the spool centred and turned")


def what_was_assumed(_: Both) -> str:
    """Say what the twins rest on."""
    drop, difference = FIRST_TEST
    return (
        f"The prototype of B.2 at Qs = {1e4 * rig.SOURCE_FLOW:.2f}×10⁻⁴ m³/s, {1e-3 * drop:.0f} kPa over the fixed "
        f"orifices, and a load difference of {1e-3 * difference:.0f} kPa, by which load 1 drops; "
        f"back pressure {1e-6 * ASSUMED.back_pressure:g} MPa, volumes {ASSUMED.volumes:g} times B.2’s (left) and "
        f"{VOLUMES[1].volumes:g} times (right), since they are not stated: all as on "
        "[the page of claims](claims.md#what-was-assumed)."
    )


def how_far_turned(_: Both) -> str:
    """Say at which angles the spool is drawn."""
    return (
        f"The thesis turns the spool “fully counter-clockwise at the end of the gear travel” and prints no angle; "
        f"ours is turned to φ/φ₀ = {POSITIONS[0]:g}, the other end of what the statement is judged over being "
        f"{POSITIONS[-1]:g}."
    )


def _converges(formulation: str) -> Judgement:
    course = _first_test(formulation, ASSUMED, (0.0, WINDOW[1]))
    after = course.times > 0.0
    gaps = np.abs(course.flows[after, 0] - course.flows[after, 1])
    left = float(gaps[-1] / gaps.max())
    settles = run_tests(formulation, ASSUMED).first.outcome is Outcome.OK
    answer = Answer.YES if settles and left <= CLOSED else Answer.IN_PART if left <= HALF_CLOSED else Answer.NO
    return Judgement(
        answer, f"a gap of {1e6 * gaps.max():.0f}×10⁻⁶ m³/s at most, {100 * left:.0f} % of it after {WINDOW[1]:g} s"
    )


def _error_of_first_test(formulation: str) -> Judgement:
    error = run_tests(formulation, ASSUMED).first.error
    near = abs(abs(error) - MEASURED_ERROR) <= steady_bias()
    answer = Answer.NO if not near else Answer.YES if error > 0 else Answer.IN_PART
    return Judgement(answer, f"{error:+.2f} %; the rig’s bias is ±{steady_bias():.1f} %")


def _not_a_step(formulation: str) -> Judgement:
    course = _first_test(formulation, ASSUMED, (0.0, WINDOW[1]))
    after = course.times > 0.0
    times, difference = course.times[after], _load_difference(course)[after]
    reached = difference / difference[-1]
    rise = float(times[np.argmax(reached >= 0.9)] - times[np.argmax(reached >= 0.1)])
    answer = Answer.YES if rise > 1 / rig.SAMPLING_RATE else Answer.NO
    return Judgement(answer, f"from 10 to 90 % in {1e3 * rise:.1f} ms")


FIRST_TEST_FLOWS = (
    Trend(
        "The flows converge after the initial disturbance",
        "Fig. 4.4",
        f"As assumed: yes if it ends `ok` and the gap between the flows after {WINDOW[1]:g} s is at most "
        f"{100 * CLOSED:g} % of the largest, in part if {100 * HALF_CLOSED:g} %.",
        _converges,
    ),
    Trend(
        "settling to a steady state error of 1.23%",
        "Fig. 4.4",
        "As assumed: yes if (3.5) is positive and its magnitude within the rig’s bias of 1.23 %, in part if only "
        "that.",
        _error_of_first_test,
    ),
    Trend(
        "the accumulated error was −0.55 L",
        "section 4.3",
        "Not judged: not explained, see [the page of claims](claims.md#litres).",
    ),
)
"""What is said of Figure 4.4."""

FIRST_TEST_PRESSURES = (
    Trend(
        "Notice that the load pressure differential was not actually a step",
        "Fig. 4.5",
        "As assumed: yes if it takes longer than one sample (4 ms) from 10 to 90 % of its final value. The load’s "
        "orifice does step in the twin: the counterbalance valves, which took their time, are not modelled.",
        _not_a_step,
    ),
)
"""What is said of Figure 4.5."""


def _first_test(formulation: str, case: Assumptions, window: tuple[float, float]) -> TimeCourse:
    return course_between(respond_in_rig(formulation, case, *FIRST_TEST), *window)


def _load_difference(course: TimeCourse) -> FloatArray:
    return np.asarray(course.states[:, 8] - course.states[:, 7])


def _flow_lines(course: TimeCourse, labels: tuple[str, ...], dash: str) -> list[Line]:
    return [Line(labels[i], course.times, course.flows[:, i] * FLOW_FACTOR, i, dash) for i in (0, 1)]
