"""Section 3.4 on the spool's radius, Figures 3.3 to 3.6."""

import math

from claims.criteria import (
    EXTREME_ERROR,
    ZERO_ERROR,
    crossings,
    rises,
    shown,
    small,
    strong,
    tail,
    too_few,
)
from claims.judgement import Answer, Chapter, Judgement, Statement
from claims.runs import AUTHOR_STEP_TIME, Runs, simulate
from divideropt.models.divider import Scenario, load_step, parameter_set
from divideropt.models.divider.study import THESIS_RANGES

OVER = 4.0
"""The error at 8 mm is over this [%]."""

CANCEL_RADIUS, CANCEL_ROUNDING = 10e-3, 0.5e-3
"""The total error vanishes at a radius that rounds to this [m]."""

LOST_RADIUS = 3e-3
"""Where control is lost [m]."""

LONGER = 10.0
"""An end of the author's run by which every spool is at rest [s]."""

OTHER_TIMES = (0.1, 0.4)
"""Half and twice the author's t_cum [s]."""


def _little_loss(runs: Runs) -> Judgement:
    return small(runs.sweep("spool_radius"), "pressure_loss", runs.base())


def _pronounced(runs: Runs) -> Judgement:
    return strong(runs.sweep("spool_radius"), "steady_state_error", runs.base())


def _over_four(runs: Runs) -> Judgement:
    error = runs.base()["steady_state_error"]
    return Judgement(Answer.YES if error > OVER else Answer.NO, f"error {error:.2f} % at 8 mm")


def _to_zero(runs: Runs) -> Judgement:
    sweep = runs.sweep("spool_radius")
    error, zeros = sweep["flow_difference"], crossings(sweep.places, sweep["flow_difference"])
    where = "zero at " + ", ".join(f"{1e3 * r:.1f} mm" for r in zeros) if zeros else "nowhere zero"
    figures = f"{error[0]:.2f} % → {error[-1]:.2f} % (signed), {where}{tail(sweep)}"
    if abs(error[-1]) <= ZERO_ERROR:
        return Judgement(Answer.YES, figures)
    return Judgement(Answer.IN_PART if zeros and abs(error[-1]) < abs(error[0]) else Answer.NO, figures)


def _dynamics_degrade(runs: Runs) -> Judgement:
    return rises(runs.sweep("spool_radius"), "dynamic_error")


def _opposite_signs(runs: Runs) -> Judgement:
    sweep = runs.sweep("spool_radius")
    opposite = (sweep["flow_difference"] > 0) & (sweep["dynamic_error"] < 0)
    part = float(opposite.mean())
    answer = Answer.YES if part == 1.0 else Answer.IN_PART if part >= 0.5 else Answer.NO
    return too_few(sweep) or Judgement(answer, f"so at {100 * part:.0f} % of the radii{tail(sweep)}")


def _total_vanishes(runs: Runs) -> Judgement:
    zeros = _zeros(runs, 0.2)
    near = [r for r in zeros if abs(r - CANCEL_RADIUS) <= CANCEL_ROUNDING]
    where = ", ".join(f"{1e3 * r:.1f} mm" for r in zeros) or "no radius from 8 to 20 mm"
    answer = Answer.YES if near else Answer.IN_PART if zeros else Answer.NO
    return Judgement(answer, f"the total is zero at {where}")


def _depends_on_time(runs: Runs) -> Judgement:
    short, usual, long = (_zeros(runs, time) for time in (OTHER_TIMES[0], 0.2, OTHER_TIMES[1]))
    words = [", ".join(f"{1e3 * r:.1f} mm" for r in zeros) or "none" for zeros in (short, usual, long)]
    apart = [round(r, 4) for zeros in (short, usual, long) for r in zeros[:1]]
    answer = Answer.YES if len(set(apart)) > 1 or len(apart) in (1, 2) else Answer.NO
    return Judgement(answer, f"zero at {words[0]} for 0.1 s, {words[1]} for 0.2 s, {words[2]} for 0.4 s")


def _control_lost(runs: Runs) -> Judgement:
    sweep = runs.sweep("spool_radius", (LOST_RADIUS,))
    error = float(sweep.results["flow_difference"][0])
    outcome = sweep.failures.removeprefix("1 ") or "ok"
    figures = f"{outcome}, signed error {shown('flow_difference', error)}"
    if outcome == "at_stop" or abs(error) >= EXTREME_ERROR:
        return Judgement(Answer.YES, figures)
    return Judgement(Answer.NO if outcome == "ok" else Answer.IN_PART, figures)


def _unstable(runs: Runs) -> Judgement:
    sweep = runs.sweep("spool_radius", (LOST_RADIUS,))
    margin = float(sweep.results["stability_margin"][0])
    if math.isnan(margin):
        return Judgement(Answer.NO, "an equilibrium is missing: there is none to be unstable")
    return Judgement(Answer.YES if margin < 0 else Answer.NO, f"stability margin {margin:.3g} 1/s")


def _zeros(runs: Runs, time: float) -> list[float]:
    sweep = runs.sweep("spool_radius", accumulation_time=time)
    return crossings(sweep.places, sweep["cumulative_error"])


def _start_note() -> str:
    """Say what the author's start does to the error at the largest radius."""
    design = parameter_set("thesis_base") | {"spool_radius": THESIS_RANGES["spool_radius"][1]}
    step = load_step(1, 15e6, at=AUTHOR_STEP_TIME)
    errors = []
    for end in (1.0, LONGER):
        ((row, _),) = simulate("listing", Scenario(events=(step,), settled=False, end_time=end), [design])
        errors.append(row["flow_difference"])
    return (
        "The error that “goes to zero”, and beyond, is one of the start. At 20 mm the listing with the author’s "
        f"start ends at {errors[0]:.2f} % after 1 s; let run to {LONGER:g} s, it ends at {errors[1]:.2f} %: a large "
        "spool is slow, and 0.4 s after the step it has not come to rest."
    )


CHAPTER = Chapter(
    "Spool radius",
    "`spool_radius` from 8 to 20 mm, 100 points; 3 mm by itself",
    (
        Statement(
            "little effect on the valve’s pressure losses", "above Fig. 3.3", "Pressure loss: small.", _little_loss
        ),
        Statement(
            "pronounced effect on the spool’s steady state accuracy",
            "Fig. 3.4",
            "Steady-state error: strong.",
            _pronounced,
        ),
        Statement("an error of over 4% (8 mm)", "Fig. 3.4", "Yes if the error at 8 mm is above 4 %.", _over_four),
        Statement(
            "reducing an error … to zero",
            "Fig. 3.4",
            "Yes if the error at 20 mm is zero; in part if it passes zero on the way and ends below where it began.",
            _to_zero,
        ),
        Statement(
            "as the steady state error improves, the dynamic performance degrades",
            "Fig. 3.4",
            "Magnitude of the dynamic error: rises with the radius.",
            _dynamics_degrade,
        ),
        Statement(
            "while the steady state error is positive …, the dynamic error is negative",
            "Fig. 3.4",
            "Yes if so at every radius, in part if at half of them.",
            _opposite_signs,
        ),
        Statement(
            "the total cumulative error goes to zero when the radius is approximately 10 mm",
            "Fig. 3.4",
            "Yes if (3.8) over 0.2 s changes sign between 9.5 and 10.5 mm; in part if elsewhere from 8 to 20 mm.",
            _total_vanishes,
        ),
        Statement(
            "this depends on the time used to calculate the cumulative error",
            "Fig. 3.4",
            "Yes if half or twice the time moves the first zero by 0.1 mm, or makes or removes one.",
            _depends_on_time,
        ),
        Statement(
            "control of the valve is lost …, the two flows diverging to an extreme dividing error",
            "Fig. 3.6",
            "At 3 mm: yes if the spool rests on its stop or the error is above 50 %; in part if it fails in another "
            "way.",
            _control_lost,
        ),
        Statement(
            "The valve appears to show instability with a radius of 3 mm",
            "Fig. 3.6",
            "Yes if the stability margin at 3 mm is negative.",
            _unstable,
        ),
    ),
    note=_start_note,
)
"""What it says of the radius."""
