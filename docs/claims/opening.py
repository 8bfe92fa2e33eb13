"""Section 3.4 on the opening of the ports and the thickness of their rims, Figures 3.18 to 3.23."""

import numpy as np

from claims.criteria import ZERO_ERROR, falls, off_line, rises, small, straight, strong, tail, too_few
from claims.judgement import Answer, Chapter, Judgement, Statement, all_of
from claims.runs import Runs
from divideropt.models.divider.study import THESIS_RANGES

AXIS = (0.1 / 1.1, 0.12 / 1.1)
"""The longest settling time of Figure 3.21 [s]: its axis ends at 1.1 times that, its last tick (of 0.02) is 0.1."""

LARGEST_SHARE = 0.5
"""The largest of several contributions, where it is more than all others together."""


def _strong_on_four(runs: Runs) -> Judgement:
    sweep, base = runs.sweep("centred_opening"), runs.base()
    names = ("steady_state_error", "dynamic_error", "settling_time", "pressure_loss")
    return all_of([strong(sweep, name, base) for name in names])


def _settling_rises(runs: Runs) -> Judgement:
    return rises(runs.sweep("centred_opening"), "settling_time")


def _axis(runs: Runs) -> Judgement:
    sweep = runs.sweep("centred_opening")
    longest = float(sweep["settling_time"].max())
    return Judgement(Answer.YES if AXIS[0] <= longest < AXIS[1] else Answer.NO, f"{1e3 * longest:.1f} ms at most")


def _moves_further(runs: Runs) -> Judgement:
    sweep = runs.sweep("centred_opening")
    travel = sweep["stroke"] / 2 - sweep["stop_clearance"]
    answer = Answer.YES if (np.diff(travel) > 0).all() else Answer.IN_PART if travel[-1] > travel[0] else Answer.NO
    return Judgement(
        answer, f"farthest from the centre {1e3 * travel[0]:.3f} mm → {1e3 * travel[-1]:.3f} mm{tail(sweep)}"
    )


def _dynamic_rises(runs: Runs) -> Judgement:
    return rises(runs.sweep("centred_opening"), "dynamic_error")


def _error_rises(runs: Runs) -> Judgement:
    return rises(runs.sweep("centred_opening"), "steady_state_error")


def _pressure_falls(runs: Runs) -> Judgement:
    return falls(runs.sweep("centred_opening"), "source_pressure")


def _rim_matters(runs: Runs) -> Judgement:
    sweep, base = runs.sweep("rim_thickness"), runs.base()
    return all_of([strong(sweep, "steady_state_error", base), rises(sweep, "steady_state_error")])


def _rim_dynamics(runs: Runs) -> Judgement:
    sweep, base = runs.sweep("rim_thickness"), runs.base()
    return all_of([small(sweep, name, base) for name in ("dynamic_error", "settling_time")])


def _rim_linear(runs: Runs) -> Judgement:
    sweep = runs.sweep("rim_thickness")
    off = off_line(sweep.places, sweep["flow_difference"])
    return too_few(sweep) or Judgement(
        straight(off), f"at most {100 * off:.1f} % of its range off the line{tail(sweep)}"
    )


def _rim_to_zero(runs: Runs) -> Judgement:
    thin, base = _thinnest(runs), abs(runs.base()["flow_difference"])
    answer = Answer.YES if thin <= ZERO_ERROR else Answer.IN_PART if thin <= 0.1 * base else Answer.NO
    return Judgement(answer, f"{thin:.3f} % at 1 µm, {base:.2f} % at 0.8 mm")


def _rim_largest(runs: Runs) -> Judgement:
    base = abs(runs.base()["flow_difference"])
    share = 1 - _thinnest(runs) / base
    return Judgement(
        Answer.YES if share > LARGEST_SHARE else Answer.NO, f"{100 * share:.1f} % of the error goes with the rim"
    )


def _thinnest(runs: Runs) -> float:
    """Return the magnitude of the error [%] at the thinnest rim of the author's range."""
    return abs(float(runs.sweep("rim_thickness", THESIS_RANGES["rim_thickness"][:1]).results["flow_difference"][0]))


OPENING = Chapter(
    "Opening of the ports, spool centred",
    "`centred_opening` from 0.2 to 0.5, 100 points",
    (
        Statement(
            "strong effects on both types of accuracy, settling time and pressure drop",
            "Figs. 3.18–3.21",
            "Steady-state error, dynamic error, settling time, pressure loss: all strong.",
            _strong_on_four,
        ),
        Statement(
            "The settling time increases as the fractional opening increases", "Fig. 3.21", "Rises.", _settling_rises
        ),
        Statement(
            "(its vertical axis, which ends at 1.1 times the longest time, has its last tick at 0.1 s)",
            "Fig. 3.21",
            "No statement, so not counted: yes if the longest settling time of the sweep is from 91 to 109 ms.",
            _axis,
            counted=False,
        ),
        Statement(
            "since the spool must move further to reach the equilibrium point",
            "Fig. 3.21",
            "The spool’s largest distance from the centre: rises.",
            _moves_further,
        ),
        Statement(
            "and pressure builds up more slowly",
            "Fig. 3.21",
            "Not judged: which pressure, and how fast, is not said.",
        ),
        Statement(
            "This effect also shows up as an increase in dynamic error",
            "Fig. 3.19",
            "Magnitude of the dynamic error: rises.",
            _dynamic_rises,
        ),
        Statement(
            "The steady state error also increases with a larger fractional opening",
            "Fig. 3.19",
            "Steady-state error: rises.",
            _error_rises,
        ),
        Statement(
            "as the fraction open decreases, … the source pressure must increase",
            "Fig. 3.20",
            "Source pressure: falls with the opening.",
            _pressure_falls,
        ),
    ),
)
"""What it says of the opening."""

RIM = Chapter(
    "Thickness of the rim",
    "`rim_thickness` from 0.001 to 2 mm, 100 points",
    (
        Statement(
            "the errors due to this force should also depend on the rim thickness. This is largely the case",
            "Fig. 3.23",
            "Steady-state error: strong, and rises with the thickness.",
            _rim_matters,
        ),
        Statement(
            "not especially noticeable in the dynamic response",
            "Fig. 3.22",
            "Dynamic error and settling time: small.",
            _rim_dynamics,
        ),
        Statement(
            "the steady state error shows a nearly linear relationship",
            "Fig. 3.23",
            "Yes if the signed error leaves the line of least squares by at most 5 % of its range, in part up to 15 "
            "%.",
            _rim_linear,
        ),
        Statement(
            "could theoretically go to a value very near zero if the rim could be made infinitely thin",
            "Fig. 3.23",
            "Yes if the error at 1 µm is zero, in part if a tenth of the base set’s.",
            _rim_to_zero,
        ),
        Statement(
            "the flow forces are the largest contributor to steady state error",
            "Fig. 3.23",
            "Yes if more than half of the base set’s error goes when the rim does.",
            _rim_largest,
        ),
        Statement(
            "as the rim becomes thinner, it becomes weaker, less durable, and more difficult to machine",
            "Fig. 3.23",
            "Not judged: the model has no strength of the rim.",
        ),
    ),
)
"""What it says of the rim."""
