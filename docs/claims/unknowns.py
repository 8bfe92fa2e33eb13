"""Section 3.4 on what a designer does not choose, Figures 3.24 to 3.28, and on all the remaining parameters."""

import math

import numpy as np

from claims.criteria import SMALL, STRONG, falls, small, span, strong
from claims.judgement import Answer, Chapter, Judgement, Statement, all_of
from claims.runs import Runs
from divideropt.models.divider import PARAMETERS
from divideropt.models.divider.study import THESIS_RANGES

REMAINING_FACTOR = 2.5
"""Upper over lower end of each remaining parameter's range: the narrowest of the author's own (radius, opening)."""

REMAINING_POINTS = 9
"""Points of each such sweep, spaced evenly in the logarithm."""

FEW = 0.25
"""In part: up to this part of the remaining parameters have a strong effect after all."""

NOT_VARIED = frozenset(THESIS_RANGES) - {"groove_angle"} | {"design_flow", "fixed_area_ratio", "groove_loss_factor"}
"""Those the statements before are about, two that say what the valve is for, and one the thesis does not have."""

EFFECTS = ("steady_state_error", "dynamic_error", "settling_time", "source_pressure")
"""By what an effect on "the valve's performance" is measured."""


def _friction_strong(runs: Runs) -> Judgement:
    return strong(runs.sweep("coulomb_friction"), "steady_state_error", runs.base())


def _friction_counteracts(runs: Runs) -> Judgement:
    return falls(runs.sweep("coulomb_friction"), "steady_state_error")


def _friction_dynamics(runs: Runs) -> Judgement:
    sweep, base = runs.sweep("coulomb_friction"), runs.base()
    return all_of([small(sweep, name, base) for name in ("dynamic_error", "settling_time")])


def _friction_stable(runs: Runs) -> Judgement:
    return _all_ok(runs, "coulomb_friction")


def _viscosity_small(runs: Runs) -> Judgement:
    sweep, base = runs.sweep("kinematic_viscosity"), runs.base()
    return all_of([small(sweep, name, base) for name in EFFECTS])


def _viscosity_usable(runs: Runs) -> Judgement:
    return _all_ok(runs, "kinematic_viscosity")


def _all_ok(runs: Runs, parameter: str) -> Judgement:
    sweep = runs.sweep(parameter)
    figures = f"{int(sweep.ok.sum())} of {len(sweep.ok)} designs are ok"
    failures = f": {sweep.failures}" if sweep.failures else ""
    return Judgement(Answer.YES if sweep.ok.all() else Answer.NO, figures + failures)


def _remaining(runs: Runs) -> Judgement:
    effects = remaining_effects(runs)
    large = [f"`{name}` ({quantity} {100 * effect:.0f} %)" for name, quantity, effect in effects if effect >= STRONG]
    answer = Answer.YES if not large else Answer.IN_PART if len(large) <= FEW * len(effects) else Answer.NO
    little = sum(effect <= SMALL for _, _, effect in effects)
    return Judgement(
        answer, f"small for {little} of {len(effects)}, strong for {len(large)}: {', '.join(large) or 'none'}"
    )


def remaining_effects(runs: Runs) -> list[tuple[str, str, float]]:
    """Vary each remaining parameter; return its name, what it moves most and how far, over the base value."""
    base, found = runs.base(), []
    for name in PARAMETERS:
        if name in NOT_VARIED:
            continue
        sweep = runs.sweep(name, _range_of(name))
        effects = {quantity: span(sweep, quantity, base) for quantity in EFFECTS}
        most = max(effects, key=effects.__getitem__)
        found.append((name, most.replace("_", " "), effects[most]))
    return sorted(found, key=lambda effect: -effect[2])


def _range_of(name: str) -> tuple[float, ...]:
    if name in THESIS_RANGES:
        low, high = THESIS_RANGES[name]
    else:
        root = math.sqrt(REMAINING_FACTOR)
        low, high = PARAMETERS[name].default / root, PARAMETERS[name].default * root
    return tuple(np.geomspace(low, high, REMAINING_POINTS).tolist())


FRICTION = Chapter(
    "Coulomb friction",
    "`coulomb_friction` from 0 to 10 N, 100 points. With friction the valve rests in a band of positions and not at "
    "a root: which of them, its way there decides",
    (
        Statement("quite a strong effect on the steady state error", "Fig. 3.25", "Strong.", _friction_strong),
        Statement(
            "appears to act counter to the other sources, reducing the total steady state error",
            "Fig. 3.25",
            "Steady-state error: falls.",
            _friction_counteracts,
        ),
        Statement(
            "does not have a major effect on the dynamic response",
            "Figs. 3.24, 3.25",
            "Dynamic error and settling time: small.",
            _friction_dynamics,
        ),
        Statement(
            "the uncertainty in its value is not likely to cause instability",
            "Fig. 3.24",
            "Yes if every design of the sweep is ok.",
            _friction_stable,
        ),
    ),
)
"""What it says of friction."""

VISCOSITY = Chapter(
    "Viscosity",
    "`kinematic_viscosity` from 15 to 66 mm²/s, 100 points",
    (
        Statement(
            "temperature will have a small effect on the proposed valve’s performance",
            "Figs. 3.26–3.28",
            "Steady-state error, dynamic error, settling time, source pressure: small.",
            _viscosity_small,
        ),
        Statement(
            "do not show the valve to be unuseable under any expected conditions",
            "Figs. 3.26–3.28",
            "Yes if every design of the sweep is ok.",
            _viscosity_usable,
        ),
        Statement(
            "corresponding to the viscosity of Nuto 30 hydraulic oil between … 60 and 25◦C",
            "above Fig. 3.26",
            "Not judged: a property of the oil.",
        ),
    ),
)
"""What it says of viscosity."""

REMAINING = Chapter(
    "All the remaining parameters",
    "`groove_angle` over the author’s range (60° to 180°); every other over a factor of 2.5 about its default, which "
    "is the narrowest of his own ranges; 9 points each. Not varied: `design_flow` and `fixed_area_ratio`, which say "
    "what the valve is for. Densities and discharge coefficients vary less than that in practice: the table below "
    "has each parameter by itself",
    (
        Statement(
            "All the remaining parameters have relatively small effects on the valve’s performance",
            "below Fig. 3.25",
            "Yes if none has a strong effect on steady-state error, dynamic error, settling time or source pressure; "
            "in part if at most a quarter of them have.",
            _remaining,
        ),
    ),
)
"""What it says of the rest."""
