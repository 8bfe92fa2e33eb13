"""The page of a sensitivity study, and the study's text for a terminal."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from divideropt.analysis.house_of_quality import STRONGEST, WORTHWHILE
from divideropt.analysis.sobol import LEAST_BLOCKS
from divideropt.analysis.treatments import MEANINGS, Treatment
from divideropt.campaign.load import stored_campaign
from divideropt.report.display import Shown, number
from divideropt.report.document import drawn, render, save
from divideropt.report.house_words import UNWRITTEN, house_rows, house_sentence
from divideropt.report.sensitivity_data import StudyData, method_of, quantity_words, read_study, write_indices
from divideropt.report.sensitivity_figures import (
    convergence,
    effect_axis,
    effects_figure,
    failures_figure,
    index_bars,
    interactions,
    variable_labels,
)
from divideropt.report.sweeps_page import write_sweeps
from divideropt.store import Store

LEAST_IN_FULL, MOST_IN_FULL = 1e-4, 1e6
"""Numbers with an interval below the one and from the other on are written with powers of ten: six places would show
them as 0."""


def write_study(store: Store, out: Path | None = None, data: StudyData | None = None) -> Path:
    """Write the page of a study, finished or not, and of a Morris or Sobol study its table of indices.

    Args:
        store: The study's store.
        out: Where to; `report.html` in the store if not given.
        data: What `read_study` found, where the caller knows; read if not given.

    Returns:
        Where the page is.

    Raises:
        UsageError: There is no study in the folder, or nothing to analyse yet.
        FileMistakes: The campaign in it cannot be read.
        StoreError: The store is damaged or of a later version.
        DiskError: The disk refused.
    """
    if method_of(stored_campaign(store)) == "oat":
        return write_sweeps(store, out)
    data = data or read_study(store)
    write_indices(data, store)
    text = render_study(data)
    return store.write_report(text) if out is None else save(out, text)


def render_study(data: StudyData) -> str:
    """Make the page; the same data give the same text."""
    figures = _figures(data)
    return render(
        "sensitivity.html.j2",
        {"figures": figures},
        data=data,
        figures={figure["id"]: figure for figure in figures},
        treatments=_treatments(data),
        meanings=[(str(treatment), words) for treatment, words in MEANINGS.items()],
        house=() if data.house is None else house_rows(data.house),
        sentence=study_sentence(data),
        worthwhile=WORTHWHILE,
        strongest=STRONGEST,
        least=LEAST_BLOCKS,
        number=number,
        quantity_words=lambda name: quantity_words(name, data.problem),
        labels=dict(variable_labels(data)),
        headings=[(axis.words, axis.symbol) for axis, _, _ in data.variables],
    )


def study_text(data: StudyData) -> str:
    """Word a Morris or Sobol study for a terminal: failures, the objectives' numbers, the House of Quality."""
    failed = f"{data.failures.total} of {data.failures.designs} designs failed ({100 * data.failures.share:.3g} %)"
    how = ", ".join(f"{count} {outcome}" for outcome, count in data.failures.outcomes.items())
    lines = [f"{data.units} {data.unit}: {failed}{': ' + how if how else ''}", *data.notes]
    names = [axis.name for axis, _, _ in data.variables]
    width = max(map(len, names))
    reasons = {item.quantity: item.reason for item in reversed(data.undefined)}  # under the first treatment
    for quantity in dict.fromkeys(o.quantity.name for o in data.problem.objectives):
        kinds = ("S1", "ST") if data.method == "sobol" else ("mu_star", "sigma")
        tables = [data.first(quantity, kind) for kind in kinds]
        if tables[0].empty:
            reason = reasons.get(quantity, "it is defined in too few designs")
            lines.append(f"{quantity_words(quantity, data.problem)}: no numbers, since {reason}")
            continue
        shown = _shown(data, quantity, tables[0])
        unit = f" [{shown.unit}]" if shown.unit else ""
        lines.append(f"{quantity_words(quantity, data.problem)}{unit}: {' and '.join(kinds)}, 95 % intervals")
        for name in names:
            cells = [_interval(table, name, shown.scale) for table in tables]
            lines.append(f"  {name:<{width}}  {'  '.join(cells)}")
    if data.house is not None:
        beside = "; in brackets the author's" if any(row.author for row in data.house.rows) else ""
        lines.append(f"House of Quality, 0 to 4{beside}:")
        for row in house_rows(data.house):
            cells = [f"{c.score}({c.author})" if c.author else c.score for c in row.cells]
            words = row.words + (", a judgement" if row.judgement else "")
            lines.append(f"  {words:<22} {row.weight or '-':>3}  {'  '.join(cells)}")
    lines.append(study_sentence(data))
    return "\n".join(line for line in lines if line)


def study_sentence(data: StudyData) -> str:
    """What follows from the study for the choice of variables; "" of a Morris study."""
    words = {axis.name: axis.words for axis, _, _ in data.variables}
    return "" if data.house is None else house_sentence(data.house, words)


def _figures(data: StudyData) -> list[dict[str, Any]]:
    found = []
    if data.method == "morris":
        found += [drawn("effects", effects_figure(data, data.objectives))] if data.objectives else []
        found += [drawn("more-effects", effects_figure(data, data.others))] if data.others else []
    else:
        labels = variable_labels(data)
        if data.objectives:
            found.append(drawn("bars", index_bars(data.indices, _worded(data, data.objectives), labels)))
            found.append(drawn("convergence", convergence(data)))
        if data.objectives and (data.indices["kind"] == "S2").any():
            found.append(drawn("interactions", interactions(data)))
        if data.others:
            found.append(drawn("more-bars", index_bars(data.indices, _worded(data, data.others), labels)))
    if data.failures.total:
        found.append(drawn("failures", failures_figure(data.failures, data.variables)))
    return found


def _worded(data: StudyData, names: Sequence[str]) -> list[tuple[str, str]]:
    return [(name, quantity_words(name, data.problem)) for name in names]


def _treatments(data: StudyData) -> list[dict[str, Any]]:
    """Of each objective, the outcome and each constraint: the main numbers under every treatment."""
    table = data.indices[data.indices["samples"] == data.indices["samples"].max()]
    kind = "ST" if data.method == "sobol" else "mu_star"
    asked = [objective.quantity.name for objective in data.problem.objectives]
    asked += [constraint.quantity.name for constraint in data.problem.constraints]
    found = []
    for quantity in dict.fromkeys(asked):
        mine = table[(table["quantity"] == quantity) & (table["kind"] == kind)]
        shown = _shown(data, quantity, mine)
        rows = []
        for treatment in Treatment:
            chosen = mine[mine["treatment"] == str(treatment)].set_index("variable")
            if not chosen.empty:
                cells = [_interval(chosen, axis.name, shown.scale) for axis, _, _ in data.variables]
                used = f"{100 * chosen['used'].min():.3g} %"
                rows.append({"treatment": str(treatment), "cells": cells, "used": used})
        if rows:
            unit = f" [{shown.unit}]" if shown.unit else ""
            found.append({"words": quantity_words(quantity, data.problem) + unit, "rows": rows})
    return found


def _shown(data: StudyData, quantity: str, table: Any) -> Shown:
    """The unit of a study's numbers: an index has none, an effect the quantity's."""
    return Shown("", 1.0) if data.method == "sobol" else effect_axis(data, quantity, table["value"].tolist()).shown


def _interval(table: Any, name: str, scale: float) -> str:
    if name not in table.index:
        return UNWRITTEN
    value = table.loc[name, "value"] * scale
    half = (table.loc[name, "high"] - table.loc[name, "value"]) * scale
    if half != half:  # noqa: PLR0124 (NaN)
        return number(value, 3)
    if max(abs(value), half) >= MOST_IN_FULL or 0.0 < max(abs(value), half) < LEAST_IN_FULL:
        return f"{number(value, 3)} ± {number(half, 2)}"
    places = max(0, 1 - math.floor(math.log10(half))) if half > 0.0 else 3  # two digits of the half width
    return f"{value:.{min(places, 6)}f} ± {half:.{min(places, 6)}f}".replace("-", "−")
