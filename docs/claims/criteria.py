"""The author's words as criteria: strong, little, falls, about, zero.

The numbers were chosen before the runs, but `FLAT`.
"""

from collections.abc import Mapping

import numpy as np

from claims.judgement import Answer, Judgement
from claims.runs import Sweep
from divideropt.models.base import FloatArray

STRONG = 0.25
"""An effect is strong (pronounced, important, significant) that spans at least this part of the base set's value."""

SMALL = 0.10
"""An effect is small (little, mostly unaffected, insignificant) that spans at most this part of it."""

NOISE = 0.01
"""A curve may step back by this part of its range and still fall (or rise) throughout."""

FLAT = 0.02
"""A curve that spans less than this part of its largest magnitude neither falls nor rises. Added after the
first runs, in which `text` had the error rise with the clearance from 2.19 to 2.20 %, and so a yes."""

HALF = 0.5
"""A curve that does not do so throughout does in part if its ends do, or if it does over this part of the range."""

ENOUGH = 2 / 3
"""A curve is judged if at least this part of its designs is ok."""

ZERO_ERROR = 0.1
"""A steady-state error of at most this [% of the source flow] is zero."""

STRAIGHT, BENT = 0.05, 0.15
"""A curve is nearly a line if it leaves the line of least squares by at most the first part of its range, and is one
in part up to the second."""

EXTREME_ERROR = 50.0
"""A dividing error of this [%] is extreme: one branch has three times the flow of the other."""

LABELS: Mapping[str, tuple[str, float, str]] = {
    "steady_state_error": ("error", 1.0, "%"),
    "flow_difference": ("signed error", 1.0, "%"),
    "dynamic_error": ("dynamic error", 1e6, "mL"),
    "settling_time": ("settling", 1e3, "ms"),
    "source_pressure": ("source pressure", 1e-6, "MPa"),
    "pressure_loss": ("pressure loss", 1e-6, "MPa"),
    "leakage": ("leakage", 1e6, "mL/s"),
}
"""Name, factor and unit of a quantity in the page."""


def falls(sweep: Sweep, quantity: str) -> Judgement:
    """Judge whether the magnitude of a quantity falls along the sweep."""
    return _goes(sweep, quantity, -1.0)


def rises(sweep: Sweep, quantity: str) -> Judgement:
    """Judge whether the magnitude of a quantity rises along the sweep."""
    return _goes(sweep, quantity, 1.0)


def strong(sweep: Sweep, quantity: str, base: Mapping[str, float]) -> Judgement:
    """Judge whether a quantity changes by at least `STRONG` of its base value; in part above `SMALL`."""
    missing = too_few(sweep)
    if missing:
        return missing
    effect = span(sweep, quantity, base)
    answer = Answer.YES if effect >= STRONG else Answer.NO if effect <= SMALL else Answer.IN_PART
    return Judgement(answer, f"{_name(quantity)} spans {100 * effect:.0f} % of its base value{tail(sweep)}")


def small(sweep: Sweep, quantity: str, base: Mapping[str, float]) -> Judgement:
    """Judge whether a quantity changes by at most `SMALL` of its base value; in part below `STRONG`."""
    opposite = strong(sweep, quantity, base)
    turned = {Answer.YES: Answer.NO, Answer.NO: Answer.YES}
    return Judgement(turned.get(opposite.answer, opposite.answer), opposite.figures)


def span(sweep: Sweep, quantity: str, base: Mapping[str, float]) -> float:
    """Return how far a quantity's values lie apart, over the magnitude of its base value."""
    return float(np.ptp(sweep[quantity]) / abs(base[quantity]))


def crossings(places: FloatArray, curve: FloatArray) -> list[float]:
    """Find where a curve changes sign, by straight lines between its points."""
    found = np.flatnonzero(np.sign(curve[:-1]) * np.sign(curve[1:]) < 0)
    return [float(places[i] - curve[i] * (places[i + 1] - places[i]) / (curve[i + 1] - curve[i])) for i in found]


def off_line(places: FloatArray, curve: FloatArray) -> float:
    """Return how far a curve leaves its line of least squares at most, over its range."""
    line = np.polyval(np.polyfit(places, curve, 1), places)
    return float(np.abs(curve - line).max() / np.ptp(curve))


def straight(off: float) -> Answer:
    """Judge by `off_line` whether a curve is nearly a line."""
    return Answer.YES if off <= STRAIGHT else Answer.IN_PART if off <= BENT else Answer.NO


def too_few(sweep: Sweep) -> Judgement | None:
    """Return the judgement of a sweep of which too little is ok, else None."""
    if sweep.ok.mean() >= ENOUGH:
        return None
    return Judgement(Answer.NOT_JUDGED, f"{int(sweep.ok.sum())} of {len(sweep.ok)} designs are ok{tail(sweep)}")


def tail(sweep: Sweep) -> str:
    """Return a remark on the designs that are not ok; empty if all are."""
    return f" (left out: {sweep.failures})" if sweep.failures else ""


def shown(quantity: str, value: float) -> str:
    """Write a quantity with three digits and its unit."""
    _, factor, unit = LABELS[quantity]
    return f"{value * factor:.3g} {unit}"


def _goes(sweep: Sweep, quantity: str, direction: float) -> Judgement:
    missing = too_few(sweep)
    if missing:
        return missing
    curve = np.abs(sweep[quantity])
    steps = direction * np.diff(curve)
    width = np.diff(sweep.places)
    part = float(width[steps > 0].sum() / width.sum())
    flat = np.ptp(curve) < FLAT * curve.max()
    if flat:
        answer = Answer.NO
    elif steps.min() >= -NOISE * np.ptp(curve) and direction * (curve[-1] - curve[0]) > 0:
        answer = Answer.YES
    elif direction * (curve[-1] - curve[0]) > 0 or part >= HALF:
        answer = Answer.IN_PART
    else:
        answer = Answer.NO
    ends = f"{_name(quantity)} {shown(quantity, curve[0])} → {shown(quantity, curve[-1])}"
    way = "" if answer is Answer.YES else ", flat" if flat else _way(sweep, curve, quantity)
    return Judgement(answer, ends + way + tail(sweep))


def _way(sweep: Sweep, curve: FloatArray, quantity: str) -> str:
    """Say where a curve that turns has its least and its largest value, as parts of the way along the sweep."""
    low, high = int(np.argmin(curve)), int(np.argmax(curve))
    at = (sweep.places - sweep.values[0]) / (sweep.values[-1] - sweep.values[0])
    return (
        f", least {shown(quantity, curve[low])} at {100 * at[low]:.0f} %,"
        f" most {shown(quantity, curve[high])} at {100 * at[high]:.0f} % of the range"
    )


def _name(quantity: str) -> str:
    return LABELS[quantity][0]
