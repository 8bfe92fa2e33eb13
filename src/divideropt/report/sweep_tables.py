"""The tables of a page of sweeps: what each parameter makes of some quantities, and of every one."""

import math
from collections.abc import Mapping

from divideropt.analysis import Effect, FailedStretch
from divideropt.report.display import Axis, number
from divideropt.report.sweeps_data import SweepFacts, SweepsData
from divideropt.report.tables import Cell, Heading, Row, Table

MOST_MOVED = 3
"""Quantities that are named as those a parameter moves most."""

SUMMARY_DIGITS = 3
"""Significant digits in the table on top, which has many columns."""

PROPORTIONAL = 1e-6
"""Effects that differ by less, relatively, are of quantities in proportion, such as a volume and its share."""

MOST_STRETCHES = 3
"""Stretches of failed designs that are named one by one."""


def summary_table(data: SweepsData) -> Table:
    """List for each parameter the range and the effect on the chosen quantities, and where it fails."""
    headings = [Heading("parameter", numeric=False), Heading("failed", numeric=False)]
    for name in data.chosen:
        axis = data.quantities[name]
        headings.append(Heading(axis.words, " ".join(p for p in (axis.symbol, axis.bracket) if p), axis.description))
    rows = []
    for part in data.parts:
        found = {effect.quantity: effect for effect in part.effects}
        cells = [Cell(f"{part.axis.words} {part.axis.symbol}".rstrip()), Cell(failed_words(part))]
        cells += [_effect_cell(found[name], data.quantities[name]) for name in data.chosen]
        rows.append(Row("", tuple(cells)))
    return Table(tuple(headings), tuple(rows))


def effects_table(part: SweepFacts, data: SweepsData) -> Table:
    """List every quantity: its range, its value at the campaign's own design, the effect, where it crosses zero."""
    headings = (
        Heading("quantity", numeric=False),
        Heading("unit", numeric=False),
        Heading("least"),
        Heading("greatest"),
        Heading("own design", title="at the campaign's own value of every parameter"),
        Heading("effect", title="greatest less least, over the magnitude at the campaign's own design"),
        Heading("zero at"),
    )
    rows = []
    for effect in part.effects:
        axis = data.quantities.get(effect.quantity)
        if axis is None:
            continue
        zeros = [part.axis.short(at) for at in part.sweep.crossings(effect.quantity)]
        cells = (
            Cell(axis.words),
            Cell(axis.shown.unit),
            *(Cell(axis.text(v)) for v in (effect.least, effect.greatest, data.base[effect.quantity])),
            Cell(share_words(effect.relative)),
            Cell(", ".join(zeros) or "–"),
        )
        rows.append(Row("", cells))
    return Table(headings, tuple(rows))


def moved(part: SweepFacts, quantities: Mapping[str, Axis]) -> str:
    """Name the quantities that a parameter moves most, of those that are proportional to each other the first."""
    if not any(math.isfinite(effect.relative) for effect in part.effects):
        return "not known: the campaign's own design, or every design here, failed"
    named: list[Effect] = []
    for effect in part.effects:
        again = any(math.isclose(effect.relative, other.relative, rel_tol=PROPORTIONAL) for other in named)
        if effect.quantity in quantities and effect.relative > 0.0 and not again:
            named.append(effect)
    words = (f"{quantities[e.quantity].words} {share_words(e.relative)}" for e in named[:MOST_MOVED])
    return "; ".join(words) or "nothing"


def failed_words(part: SweepFacts) -> str:
    """Say how many designs of a sweep failed, where and how."""
    sweep = part.sweep
    if sweep.failed == 0:
        return "none"
    stretches = sweep.failures()
    words = [_stretch_words(stretch, part.axis) for stretch in stretches[:MOST_STRETCHES]]
    words += [f"and {len(stretches) - MOST_STRETCHES} stretches more"] if len(stretches) > MOST_STRETCHES else []
    share = number(100.0 * sweep.failed / len(sweep.values), 2)
    return f"{sweep.failed} of {len(sweep.values)} ({share} %): {'; '.join(words)}"


def share_words(share: float) -> str:
    """Write a share as percent, or as a multiple from ten times on."""
    if math.isnan(share):
        return "–"
    return f"×{share:.0f}" if share >= 10.0 else f"{number(100.0 * share, 2)} %"


def _effect_cell(effect: Effect, axis: Axis) -> Cell:
    if math.isnan(effect.least):
        return Cell("–")
    least, greatest = (number(axis.scaled(value), SUMMARY_DIGITS) for value in (effect.least, effect.greatest))
    return Cell(f"{least} … {greatest} ({share_words(effect.relative)})")


def _stretch_words(stretch: FailedStretch, axis: Axis) -> str:
    how = ", ".join(stretch.outcomes)
    if stretch.count == 1:
        return f"{how} at {axis.short(stretch.begin)}"
    return f"{how} from {axis.short(stretch.begin)} to {axis.short(stretch.end)}"
