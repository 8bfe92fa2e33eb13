"""Section 3.4 on the groove's width and the clearance, Figures 3.7 to 3.11."""

import math
from dataclasses import replace

import numpy as np

from claims.criteria import falls, rises, shown, small, strong, tail, too_few
from claims.judgement import Answer, Chapter, Judgement, Statement, all_of
from claims.runs import Runs
from claims.slip import leakage_note
from divideropt.models.divider.pilot import pilot_sides
from divideropt.models.divider.study import THESIS_RANGES

LARGE = 2.0
"""The error at the widest groove is large from this multiple of the base set's on."""

LARGE_SHARE = 0.25
"""A large portion of the source flow, as through the pilot stage."""

DAMPING_FACTORS = (0.1, 0.2, 0.5, 1.0, 2.0, 2.4)
"""Viscous friction over that of the base set. Land length and its share of the spool go together, which leaves spool
length and mass as they are; the share ends below 1."""


def _important(runs: Runs) -> Judgement:
    sweep, base = runs.sweep("groove_width"), runs.base()
    return all_of([strong(sweep, name, base) for name in ("steady_state_error", "dynamic_error")])


def _complex(runs: Runs) -> Judgement:
    sweep = runs.sweep("groove_width")
    turns = {}
    for name in ("steady_state_error", "dynamic_error", "settling_time"):
        directions = (falls(sweep, name).answer, rises(sweep, name).answer)
        turns[name] = Answer.YES not in directions
    turning = [name.replace("_", " ") for name, turn in turns.items() if turn]
    answer = Answer.YES if len(turning) == len(turns) else Answer.IN_PART if turning else Answer.NO
    return too_few(sweep) or Judgement(answer, f"turning: {', '.join(turning) or 'none'}{tail(sweep)}")


def _small_when_narrow(runs: Runs) -> Judgement:
    sweep = runs.sweep("groove_width")
    low, high = THESIS_RANGES["groove_width"]
    narrow = sweep.places <= low + (high - low) / 3
    parts = []
    for name in ("steady_state_error", "dynamic_error"):
        curve = np.abs(sweep[name])
        worst, mean = float(curve[narrow].max()), float(curve.mean())
        figures = (
            f"{name.replace('_', ' ')} up to {shown(name, worst)} below 0.87 mm, mean of all {shown(name, mean)}"
        )
        parts.append(Judgement(Answer.YES if worst < mean else Answer.NO, figures))
    return too_few(sweep) or all_of(parts)


def _bypass(runs: Runs) -> Judgement:
    share = float(runs.sweep("groove_width", THESIS_RANGES["groove_width"][1:]).results["pilot_share"][0])
    usual = runs.base()["pilot_share"]
    answer = Answer.YES if share >= LARGE_SHARE else Answer.NO
    if math.isnan(share):
        answer = Answer.NOT_JUDGED
    return Judgement(answer, f"{100 * share:.0f} % at 2 mm, {100 * usual:.0f} % at 1 mm")


def _large_when_wide(runs: Runs) -> Judgement:
    widest = runs.sweep("groove_width", THESIS_RANGES["groove_width"][1:])
    error, usual = float(widest.results["steady_state_error"][0]), runs.base()["steady_state_error"]
    answer = Answer.YES if error >= LARGE * usual else Answer.IN_PART if error > usual else Answer.NO
    if math.isnan(error):
        answer = Answer.NOT_JUDGED
    outcome = f" ({widest.failures.removeprefix('1 ')})" if widest.failures else ""
    return Judgement(answer, f"{error:.2f} % at 2 mm{outcome}, {usual:.2f} % at 1 mm")


def _perhaps_unstable(runs: Runs) -> Judgement:
    sweep = runs.sweep("groove_width")
    low, high = THESIS_RANGES["groove_width"]
    wide = sweep.values >= high - (high - low) / 3
    margin = sweep.results["stability_margin"][wide]
    least = float(np.nanmin(margin))
    unstable = int((margin < 0).sum())
    figures = f"{unstable} of {int(wide.sum())} designs from 1.43 mm on, least margin {least:.3g} 1/s"
    return Judgement(Answer.YES if unstable else Answer.NO, figures)


def _clearance_matters(runs: Runs) -> Judgement:
    return strong(runs.sweep("radial_clearance"), "steady_state_error", runs.base())


def _dynamics_unaffected(runs: Runs) -> Judgement:
    sweep, base = runs.sweep("radial_clearance"), runs.base()
    return all_of([small(sweep, name, base) for name in ("dynamic_error", "settling_time")])


def _less_leakage(runs: Runs) -> Judgement:
    sweep = runs.sweep("radial_clearance")
    over_lands = np.array([_over_lands(runs, clearance) for clearance in sweep.places.tolist()])
    found = rises(replace(sweep, results={"leakage": over_lands}, ok=np.ones(len(over_lands), dtype=bool)), "leakage")
    lost = sweep["leakage"]
    surplus = ", more flow than is supplied" if lost[-1] < 0 else ""
    balance = f"Qs − QL1 − QL2 {shown('leakage', lost[0])} → {shown('leakage', lost[-1])}{surplus}"
    return Judgement(found.answer, f"over the lands, {found.figures}; {balance}{tail(sweep)}")


def _over_lands(runs: Runs, clearance: float) -> float:
    """Add up the magnitudes of Qla and Qlb of both sides, (2.42)-(2.45), where the response ends [m^3/s]."""
    response = runs.response({"radial_clearance": clearance})
    stay = response.phases[-1]
    if stay.end is None:
        return math.nan
    sides = pilot_sides(response.parameters, stay.span.inputs.spool_position, response.valve.formulation)
    around = (stay.end[[0, 1, 3]], stay.end[[0, 2, 4]])  # Ps, Pa, Pb of each side
    flows = [
        flow @ p for side, p in zip(sides, around, strict=True) for flow in (side.chamber_leakage, side.end_leakage)
    ]
    return float(np.abs(flows).sum())


def _tighter_is_better(runs: Runs) -> Judgement:
    return rises(runs.sweep("radial_clearance"), "steady_state_error")


def _damping_insignificant(runs: Runs) -> Judgement:
    base = runs.base()
    changes = [{"land_length_ratio": 8.0 * k, "land_fraction": 0.4 * k} for k in DAMPING_FACTORS]
    found = [row for row, _ in runs.designs(changes)]
    parts = []
    for name in ("dynamic_error", "settling_time"):
        effect = float(np.ptp([row[name] for row in found])) / abs(base[name])
        answer = Answer.YES if effect <= 0.10 else Answer.IN_PART if effect < 0.25 else Answer.NO
        parts.append(Judgement(answer, f"{name.replace('_', ' ')} spans {100 * effect:.1f} %"))
    return all_of(parts)


WIDTH = Chapter(
    "Width of the pilot groove",
    "`groove_width` from 0.3 to 2 mm, 100 points",
    (
        Statement(
            "can be expected to have an important effect on the valve",
            "eq. 3.23",
            "Steady-state and dynamic error: strong.",
            _important,
        ),
        Statement(
            "These curves show a complex shape",
            "Figs. 3.8, 3.9",
            "Yes if error, dynamic error and settling time all turn within the range; in part if some do.",
            _complex,
        ),
        Statement(
            "For smaller widths, the steady state and dynamic errors are relatively small",
            "Fig. 3.8",
            "For each: the largest in the lower third of the range is below the mean over all of it; in part if for "
            "one.",
            _small_when_narrow,
        ),
        Statement(
            "For very large widths, … causing a large portion of flow to bypass … via the pilot stage",
            "Fig. 3.7",
            "Yes if a quarter of the source flow goes through the grooves at 2 mm (`pilot_share`).",
            _bypass,
        ),
        Statement(
            "In this case, the steady state error becomes large",
            "Fig. 3.8",
            "Yes if the error at 2 mm is twice the base set’s (1 mm), in part if above it.",
            _large_when_wide,
        ),
        Statement(
            "and there may be instability, as shown in the response before the step",
            "Fig. 3.7",
            "Yes if a design in the upper third of the range has a negative stability margin.",
            _perhaps_unstable,
        ),
    ),
)
"""What it says of the groove's width."""

CLEARANCE = Chapter(
    "Clearance",
    "`radial_clearance` from 1 to 20 µm, 100 points",
    (
        Statement(
            "it too would have a significant effect …, largely related to the steady state",
            "Fig. 3.11",
            "Steady-state error: strong.",
            _clearance_matters,
        ),
        Statement(
            "the settling time and dynamic error are mostly unaffected",
            "Fig. 3.10",
            "Both: small.",
            _dynamics_unaffected,
        ),
        Statement(
            "A tighter clearance allows less leakage",
            "Fig. 3.11",
            "Leakage over the lands, the magnitudes of (2.42)–(2.45) added up: rises with the clearance. (What "
            "reaches no load, Qs − QL1 − QL2, is another matter: a surplus is fluid from nowhere.)",
            _less_leakage,
        ),
        Statement(
            "which translates into a lower steady state error",
            "Fig. 3.11",
            "Steady-state error: rises with the clearance.",
            _tighter_is_better,
        ),
        Statement(
            "The tighter clearance does increase the viscous damping force, but … insignificant contribution",
            "below Fig. 3.9",
            "Viscous friction by itself, from a tenth of the base set’s to 2.4 times it: dynamic error and settling "
            "time small.",
            _damping_insignificant,
        ),
        Statement(
            "more expensive …, more prone to failure due to particulate contamination and thermal expansion",
            "below Fig. 3.9",
            "Not judged: the model has neither cost, dirt nor heat.",
        ),
    ),
    note=leakage_note,
)
"""What it says of the clearance."""
