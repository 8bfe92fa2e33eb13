"""Section 3.4 on the total pressure drop and its share at the fixed orifice, Figures 3.12 to 3.17."""

from claims.criteria import crossings, falls, rises, strong, tail
from claims.judgement import Answer, Chapter, Judgement, Statement, all_of
from claims.runs import Runs, Sweep

OVERSHOOT = 0.05
"""The flows overshoot where this part of the volume error is made on the other side of the final flows."""

SOURCE_FLOW = 1e-3
"""Qs of the standard test [m^3/s]."""

CANCEL_RATIO, CANCEL_ROUNDING = 0.95, 0.005
"""The errors cancel at a ratio that rounds to this."""


def _overshoot(runs: Runs) -> Judgement:
    sweep = runs.sweep("total_pressure_drop")
    low, high = (_other_side(sweep, i) for i in (0, -1))
    answer = Answer.YES if low >= OVERSHOOT and low > high else Answer.NO
    at = f"{1e-6 * sweep.places[0]:.2f} MPa, the least that is ok"
    beyond = 100 * (sweep["load_flow_1"][0] / (SOURCE_FLOW / 2) - 1)
    past = (
        f"QL1 ends {beyond:.1f} % above half the source flow" if beyond > 0 else "QL1 ends below half the source flow"
    )
    return Judgement(
        answer, f"{100 * low:.1f} % at {at}, {100 * high:.1f} % at 10 MPa; at the former {past}{tail(sweep)}"
    )


def _other_side(sweep: Sweep, i: int) -> float:
    """Return the part of ∫|·| of (3.10) whose sign is the rarer one."""
    whole, net = sweep["dynamic_error_abs"][i], sweep["dynamic_error"][i]
    return float((whole - abs(net)) / 2 / whole)


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
            "Yes if at the smallest drop that is ok 5 % of the volume error lies beyond the final flows, and more "
            "than at 10 MPa. (Not an overshoot but a steady-state error: to rest beyond half the source flow.)",
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
            "cancel each other out at a ratio of about 0.95",
            "Fig. 3.16",
            "Yes if (3.8) over 0.2 s changes sign between 0.945 and 0.955; in part if elsewhere in the range.",
            _cancel,
        ),
    ),
)
"""What it says of the ratio."""
