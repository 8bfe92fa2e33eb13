"""The page of a one-at-a-time study: frozen data to one HTML file, with the figures of section 3.4 of the thesis."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from divideropt.report.display import number
from divideropt.report.document import drawn, render, save
from divideropt.report.sweep_figures import (
    errors_figure,
    flows_figure,
    panel_numbers,
    panels_figure,
    quantity_figure,
    step_zoom_figure,
)
from divideropt.report.sweep_tables import effects_table, failed_words, moved, summary_table
from divideropt.report.sweeps_data import SweepFacts, SweepsData, read_sweeps
from divideropt.store import Store

THESIS_FIGURES: Mapping[str, str] = MappingProxyType(
    {
        "spool_radius": "3.3 to 3.5",
        "groove_width": "3.7 to 3.9",
        "radial_clearance": "3.10 and 3.11",
        "total_pressure_drop": "3.12 to 3.14",
        "fixed_drop_ratio": "3.15 to 3.17",
        "centred_opening": "3.18 to 3.21",
        "rim_thickness": "3.22 and 3.23",
        "coulomb_friction": "3.24 and 3.25",
        "kinematic_viscosity": "3.26 to 3.28",
    }
)
"""Which figures of the thesis show a parameter's sweep; the groove's angle was swept and not printed."""


def write_sweeps(store: Store, out: Path | None = None) -> Path:
    """Write the page of a study, finished or not.

    Args:
        store: The study's own store.
        out: Where to; `report.html` in the store if not given.

    Returns:
        Where it is.

    Raises:
        UsageError: There is no store in the folder, or it is of no study one parameter at a time.
        FileMistakes: The campaign in it cannot be read.
        StoreError: The store is damaged or of a later version.
        DiskError: The disk refused.
    """
    text = render_sweeps(read_sweeps(store))
    return store.write_report(text) if out is None else save(out, text)


def render_sweeps(data: SweepsData) -> str:
    """Make the page; the same data give the same text."""
    sections = [_section(i, part, data) for i, part in enumerate(data.parts)]
    figures = [figure for section in sections for figure in section["figures"]]
    chosen = next(iter(data.drawn or data.quantities), None) if data.parts else None
    payload: dict[str, Any] = {"figures": figures}
    if chosen is not None:
        payload["figures"].append(drawn("panels", panels_figure(data, chosen)))
        payload["quantities"] = panel_numbers(data)
    return render(
        "sweeps.html.j2",
        payload,
        data=data,
        sections=sections,
        chosen=chosen,
        summary=summary_table(data),
        number=number,
    )


def _section(place: int, part: SweepFacts, data: SweepsData) -> dict[str, Any]:
    """What the page shows of one parameter."""
    figures = []
    if part.responses:
        figures += [_figure(place, "flows", flows_figure(part), "load flows over time")]
        figures += [_figure(place, "step", step_zoom_figure(part), "load flows around the step")]
    if data.errors:
        figures.append(_figure(place, "errors", errors_figure(part), "errors"))
    for i, name in enumerate(data.drawn):
        axis = data.quantities[name]
        figures.append(_figure(place, f"quantity-{i}", quantity_figure(part, axis), axis.words))
    zeros = {data.quantities[e.quantity].words: part.sweep.crossings(e.quantity) for e in part.effects
             if e.quantity in data.quantities}  # fmt: skip
    return {
        "id": f"parameter-{place}",
        "part": part,
        "figures": figures,
        "flows": [figure for figure in figures if figure["id"].startswith(("flows", "step"))],
        "moved": moved(part, data.quantities),
        "zeros": [f"{words} at {', '.join(part.axis.short(v) for v in at)}" for words, at in zeros.items() if at],
        "failed": failed_words(part),
        "undrawn": [r for r in part.responses if r.curve is None],
        "thesis": THESIS_FIGURES.get(part.sweep.parameter) if data.errors else None,
        "table": effects_table(part, data),
    }


def _figure(place: int, kind: str, figure: Any, words: str) -> dict[str, Any]:
    return drawn(f"{kind}-{place}", figure, words=words)
