"""Section 3.4 on the total pressure drop and its share at the fixed orifice, Figures 3.12 to 3.17."""

import math

import numpy as np

from claims.criteria import FLAT, SMALL, crossings, falls, rises, strong, tail, too_few
from claims.judgement import Answer, Chapter, Judgement, Statement, all_of
from claims.runs import Runs
from divideropt.models.divider import PARAMETERS

OVERSHOOT = 0.05
"""A flow overshoots that goes this part of its final value beyond it."""

USUAL_DROP = PARAMETERS["total_pressure_drop"].default
"""Of the base set [Pa]."""

CANCEL_RATIO, CANCEL_ROUNDING = 0.95, 0.005
"""The errors cancel at a ratio that rounds to this."""


def _overshoot(runs: Runs) -> Judgement:
    sweep = runs.sweep("total_pressure_drop")
    drops = (float(sweep.places[0]), USUAL_DROP, float(sweep.places[-1]))
    beyond = {drop: overshoots(runs, drop) for drop in drops}
    least, usual, most = (max(flows) for flows in beyond.values())
    signs = (least >= OVERSHOOT, least > max(usual, most))
    answer = Answer.YES if all(signs) else Answer.IN_PART if any(signs) else Answer.NO
    figures = "; ".join(
        f"at {1e-6 * drop:.3g} MPa QL1 by {100 * first:.1f} %, QL2 by {100 * second:.1f} %"
        for drop, (first, second) in beyond.items()
    )
    return Judgement(answer, figures + tail(sweep))


def overshoots(runs: Runs, drop: float) -> tuple[float, float]:
    """Return how far QL1 and QL2 go beyond their final values, over these: away from where the step throws them."""
    response = runs.response({"total_pressure_drop": drop})
    stay = response.phases[-1]
    if stay.trajectory is None or stay.end is None or stay.rest is None:
        return math.nan, math.nan
    final = stay.load_flows(stay.rest.state if response.rests_at_root else stay.end)
    flows = stay.load_flows(np.swapaxes(stay.trajectory.values, 1, 2)).reshape(-1, 2)
    off = flows / final - 1
    first, second = np.maximum((-np.sign(off[0]) * off).max(axis=0), 0.0)
    return float(first), float(second)


def _drop_changes(runs: Runs) -> Judgement:
    response = runs.response({})
    before, after = response.phases[0].end, response.phases[-1].end
    if before is None or after is None:
        return Judgement(Answer.NOT_JUDGED, "an equilibrium is missing")
    equal, greater, smaller = (float(y[0] - y[load]) for y, load in ((before, 7), (after, 7), (after, 8)))
    change = abs(greater / equal - 1)
    answer = Answer.YES if change > SMALL else Answer.IN_PART if change > FLAT else Answer.NO
    return Judgement(
        answer,
        f"{1e-6 * equal:.2f} MPa at equal loads; {1e-6 * greater:.2f} MPa to the greater load after the step "
        f"({100 * (greater / equal - 1):+.0f} %), {1e-6 * smaller:.2f} MPa to the other; ports fully open "
        f"{1e-6 * response.geometry.open_drop:.2f} MPa, for which {1e-6 * USUAL_DROP:g} was set",
    )


def _drop_errors_fall(runs: Runs) -> Judgement:
    sweep = runs.sweep("total_pressure_drop")
    return all_of([falls(sweep, name) for name in ("steady_state_error", "dynamic_error")])


def _drop_settling_falls(runs: Runs) -> Judgement:
    return falls(runs.sweep("total_pressure_drop"), "settling_time")


def _bought(runs: Runs) -> Judgement:
    sweep = runs.sweep("total_pressure_drop")
    return all_of([falls(sweep, "steady_state_error"), rises(sweep, "pressure_loss")])


def _ratio_strong(runs: Runs) -> Judgement:
    sweep, base = runs.sweep("fixed_drop_ratio"), runs.base()
    return all_of([strong(sweep, name, base) for name in ("steady_state_error", "dynamic_error")])


def _ratio_steady_falls(runs: Runs) -> Judgement:
    return falls(runs.sweep("fixed_drop_ratio"), "steady_state_error")


def _ratio_dynamic_falls(runs: Runs) -> Judgement:
    return falls(runs.sweep("fixed_drop_ratio"), "dynamic_error")


def _ratio_opposite(runs: Runs) -> Judgement:
    sweep = runs.sweep("fixed_drop_ratio")
    part = float((sweep["flow_difference"] * sweep["dynamic_error"] < 0).mean())
    answer = Answer.YES if part == 1.0 else Answer.IN_PART if part >= 0.5 else Answer.NO
    return too_few(sweep) or Judgement(answer, f"so at {100 * part:.0f} % of the ratios{tail(sweep)}")


def _cancel(runs: Runs) -> Judgement:
    sweep = runs.sweep("fixed_drop_ratio")
    zeros = crossings(sweep.places, sweep["cumulative_error"])
    near = [ratio for ratio in zeros if abs(ratio - CANCEL_RATIO) <= CANCEL_ROUNDING]
    where = ", ".join(f"{ratio:.3f}" for ratio in zeros) or "no ratio"
    answer = Answer.YES if near else Answer.IN_PART if zeros else Answer.NO
    return Judgement(answer, f"the total is zero at {where}{tail(sweep)}")


TOTAL = Chapter(
    "Total pressure drop",
    "`total_pressure_drop` from 1 to 10 MPa, 100 points",
    (
        Statement(
            "if the pressure drop is too small, the flows overshoot",
            "Fig. 3.12",
            "How far each flow goes beyond its own final value, away from where the step throws it. Yes if at the "
            "smallest drop that is ok one does by 5 %, and by more than at 3 and 10 MPa; in part if one of these "
            "two.",
            _overshoot,
        ),
        Statement(
            "As the pressure drop increases, both the dynamic and steady state error decrease",
            "Fig. 3.13",
            "Both magnitudes: fall.",
            _drop_errors_fall,
        ),
        Statement("as does the settling time", "Fig. 3.14", "Settling time: falls.", _drop_settling_falls),
        Statement(
            "one can “buy” accuracy in a flow divider at the cost of pressure losses",
            "Figs. 3.12–3.14",
            "Along the sweep the steady-state error falls and the pressure loss rises.",
            _bought,
        ),
        Statement(
            "is the pressure drop when the … load pressures are equal …, and can change when the load pressures are "
            "different",
            "below Fig. 3.11",
            "Ps − PL of the base set before and after the step: yes if over the branch with the greater load it "
            "changes by more than 10 %, in part by more than 2 %.",
            _drop_changes,
        ),
    ),
)
"""What it says of the total drop."""

RATIO = Chapter(
    "Share of the drop at the fixed orifice",
    "`fixed_drop_ratio` from 0.1 to 0.99, 100 points",
    (
        Statement(
            "quite a strong effect on both the steady state error and the dynamic error",
            "Fig. 3.16",
            "Both: strong.",
            _ratio_strong,
        ),
        Statement(
            "steady state error decrease[s] as the portion … across the fixed orifice increases",
            "Fig. 3.16",
            "Steady-state error: falls.",
            _ratio_steady_falls,
        ),
        Statement(
            "dynamic … error decrease[s] as the portion … across the fixed orifice increases",
            "Fig. 3.16",
            "Magnitude of the dynamic error: falls.",
            _ratio_dynamic_falls,
        ),
        Statement(
            "notice that the dynamic and steady state error act in opposite directions",
            "Fig. 3.16",
            "Signs of (3.5) and (3.10) opposite: yes if so at every ratio, in part if at half of them.",
            _ratio_opposite,
        ),
        Statement(
            "cancel each other out at a ratio of about 0.95",
            "Fig. 3.16",
            "Yes if (3.8) over 0.2 s changes sign between 0.945 and 0.955; in part if elsewhere in the range.",
            _cancel,
        ),
    ),
)
"""What it says of the ratio."""
