"""The report's page: frozen data to one HTML file."""

import base64
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from divideropt.analysis import Summary
from divideropt.campaign.load import stored_campaign
from divideropt.report.comparison_figure import comparison_figure
from divideropt.report.convergence_figure import EARLY, convergence_figure
from divideropt.report.convergence_tables import convergence_table, unequal
from divideropt.report.cost_figure import FRONTS, cost_figures, kind_of
from divideropt.report.cost_tables import bests_table, reasons_table, volumes_table
from divideropt.report.data import ReportData, read_report
from divideropt.report.decision_tables import choosing_table, lacking, rank_table, strategies_table
from divideropt.report.display import Axis, brief, grouped, number, rounded, share
from divideropt.report.document import drawn, render, save
from divideropt.report.drawn import MOST_ROWS
from divideropt.report.failing import FEW
from divideropt.report.failing_tables import along_table, bounds_table
from divideropt.report.figures import front_3d, projections, residuals
from divideropt.report.palette import COLOURS, Mark, marks
from divideropt.report.provenance_tables import versions_table
from divideropt.report.responses import Responses
from divideropt.report.scenario_tables import scenario_tables
from divideropt.report.sensitivity_data import is_study
from divideropt.report.sensitivity_figures import index_bars
from divideropt.report.sensitivity_page import write_study
from divideropt.report.sheets import FIRST, MOST_SIMULATED, sheets_payload
from divideropt.report.sketch_svg import DEFS, light_style
from divideropt.report.sketches import sketch_payload
from divideropt.report.step_figure import step_figure, step_window
from divideropt.report.summary_tables import goals_table
from divideropt.report.tables import (
    best_table,
    commonest_failure,
    front_table,
    outcome_table,
    runs_table,
    verified_words,
)
from divideropt.store import Store

MOST_DEVIATING = 40
"""Deviating designs that the page lists above the table, where each is marked."""


def write_report(store: Store, out: Path | None = None, logs: Mapping[str, Summary] | None = None) -> Path:
    """Write the report of a store, finished or not; of a sensitivity study its page.

    Args:
        store: The store.
        out: Where to; `report.html` in the store if not given.
        logs: Each run's log, summed up, where the caller knows; read if not given.

    Returns:
        Where it is.

    Raises:
        UsageError: There is no store in the folder, or too little of a study to analyse.
        FileMistakes: The campaign in it cannot be read.
        StoreError: The store is damaged or of a later version.
        DiskError: The disk refused.
    """
    if is_study(stored_campaign(store)):
        return write_study(store, out)
    text = render_report(read_report(store, logs))
    return store.write_report(text) if out is None else save(out, text)


def render_report(data: ReportData) -> str:
    """Make the page; the same data give the same text."""
    figures, selection = _figures(data), _selection(data)
    return render(
        "report.html.j2",
        {"figures": figures, **selection},
        data=data,
        drawing=selection.get("sketch"),
        figures={figure["id"]: figure for figure in figures},
        projections=[figure for figure in figures if figure["id"].startswith("projection")],
        costs=[figure for figure in figures if figure["id"].startswith("cost")],
        cost_marks=_cost_marks(data),
        marks=marks(data.strategies),
        counts={name: sum(d.strategy == name for d in data.front) for name in data.strategies},
        tables={
            "goals": goals_table(data.headline),
            "best": best_table(data),
            "front": front_table(data, MOST_ROWS),
            "runs": runs_table(data),
            "outcomes": outcome_table(data),
            "along": along_table(data.failing),
            "bounds": bounds_table(data.failing),
            "convergence": convergence_table(data.tracks),
            "versions": versions_table(data.provenance),
            "choosing": choosing_table(data),
            "strategies": strategies_table(data),
            "tests": rank_table(data),
            "bests": bests_table(data),
            "reasons": reasons_table(data),
            "volumes": volumes_table(data),
        },
        pairs=math.comb(len(data.objectives), 2),
        commonest_failure=commonest_failure(data),
        unequal=unequal(data.tracks),
        share=share,
        early=EARLY,
        few=FEW,
        grouped=grouped,
        brief=brief,
        scenarios=scenario_tables(data.scenarios, dict(data.setting)),
        lacking=lacking(data),
        first_step=FIRST,
        most_simulated=MOST_SIMULATED,
        rounded=[] if data.sheets is None else [name.replace("_", " ") for name in data.sheets.rounded],
        number=number,
        verified_words=lambda design: verified_words(design, data),
        most_rows=MOST_ROWS,
        most_deviating=MOST_DEVIATING,
    )


def _figures(data: ReportData) -> list[dict[str, Any]]:
    found = []
    if data.front:
        found += _front_figures(data)
    if any(run.feasible for run in data.runs):
        found += [drawn(track.name, convergence_figure(track, data.strategies)) for track in data.tracks]
    if data.cost is not None:
        for pair, figure in cost_figures(data):
            names = " and ".join(data.objectives[i].axis.words for i in pair)
            found.append(drawn(f"cost-{pair[0]}-{pair[1]}", figure, axes=list(pair), words=names))
    if data.kkt.computed:
        found.append(drawn("residuals", residuals(data)))
    if data.comparison is not None:
        found.append(drawn("indicators", comparison_figure(data.comparison)))
    if data.front and data.responses is not None:
        found.append(drawn("response", step_figure(data.responses)))
    for study in data.studies:
        if study.sobol is not None and study.sobol.objectives:
            sobol = study.sobol
            found.append(drawn(f"study-{study.name}", index_bars(sobol.indices, sobol.objectives, sobol.variables)))
    return found


def _front_figures(data: ReportData) -> list[dict[str, Any]]:
    found = []
    if len(data.objectives) >= 3:
        found.append(drawn("front", front_3d(data), webgl=True, axes=[0, 1, 2]))
    for pair, figure in projections(data):
        names = " and ".join(data.objectives[i].axis.words for i in pair)
        found.append(drawn(f"projection-{pair[0]}-{pair[1]}", figure, axes=list(pair), words=names, dotted=True))
    return found


def _cost_marks(data: ReportData) -> list[tuple[Mark, str, int]]:
    """The marks of the fronts in the figures of what robustness costs, with words and a count."""
    kinds = [kind_of(place) for place in data.cost.placed] if data.cost else []
    return [
        (Mark(COLOURS.index(colour), shape), words, kinds.count(kind))
        for kind, (words, colour, shape) in FRONTS.items()
    ]


def _selection(data: ReportData) -> dict[str, Any]:
    """What the page needs to select designs and to show them."""
    if not data.front:
        return {"selected": None}
    responses, designs = data.responses, _designs(data)
    return {
        "fields": [_field(facts.axis, lower=facts.lower, upper=facts.upper) for facts in data.variables]
        + [_field(facts.axis, goal=facts.goal) for facts in data.objectives],
        "objectives": len(data.objectives),
        "designs": designs,
        "tried": _tried(data),
        "responses": {} if responses is None else _curves(responses),
        "selected": _first(data),
        "name": data.name,
        "simulates": responses is not None,
        **_dimensions(data, designs),
    }


def _dimensions(data: ReportData, designs: Mapping[str, Any]) -> dict[str, Any]:
    """What the page needs to draw its designs to scale, and to list their dimensions."""
    if data.sketches is None:
        return {}
    variables = np.array(designs["values"][: len(data.variables)], dtype=np.float64).T
    valves = [] if data.sheets is None else [column.dimensions for column in data.sheets.valves]
    drawing = sketch_payload(data.sketches, variables, valves)
    if drawing is None:
        return {}
    found: dict[str, Any] = {"sketch": {**drawing, "defs": DEFS, "style": light_style()}}
    return found if data.sheets is None else {**found, "sheets": sheets_payload(data.sheets)}


def _curves(responses: Responses) -> dict[str, Any]:
    return {r.name: {"t": r.times, "q": r.flows, "window": step_window(r, responses.sets)} for r in responses.designs}


def _field(
    axis: Axis, lower: float | None = None, upper: float | None = None, goal: float | None = None
) -> dict[str, Any]:
    """Word a column: bounds and goal in the platform's unit; `scale` makes the unit shown of it."""
    return {
        "name": axis.name,
        "words": axis.words,
        "detail": axis.detail,
        "label": axis.label,
        "unit": axis.unit,
        "magnitude": axis.magnitude,
        "shown": axis.shown.unit,
        "scale": axis.shown.scale,
        "lower": lower,
        "upper": upper,
        "goal": goal,
        "goal_words": None if goal is None else axis.bound(goal),
    }


def _designs(data: ReportData) -> dict[str, Any]:
    """Every design that the page can show, a list a column: first those drawn, the best of them first."""
    closely = {response.name for response in data.responses.designs} if data.responses else set()
    closely |= data.sheets.designs.keys() if data.sheets else set()
    more = [design for design in (*data.front, *data.best) if design.design_id in closely]
    more += [*data.best, *(candidate.design for candidate in (data.choosing.candidates if data.choosing else ()))]
    listed = data.front[:MOST_ROWS]
    known = {design.design_id: design for design in (*(data.front[i] for i in data.drawn), *listed, *more)}
    places = {name: place for place, name in enumerate(data.strategies)}
    rows = [(*design.variables, *design.objectives) for design in known.values()]
    return {
        "ids": list(known),
        "drawn": len(data.drawn),
        "strategy": [places.get(design.strategy, 0) for design in known.values()],
        "values": [
            [value if math.isfinite(value) else None for value in column] for column in zip(*rows, strict=True)
        ],
        "valid": None
        if all(design.valid is None for design in known.values())
        else [None if design.valid is None else int(design.valid) for design in known.values()],
        "attainment": None
        if data.front[0].attainment is None
        else [None if d.attainment is None else rounded(d.attainment) for d in known.values()],
    }


def _tried(data: ReportData) -> dict[str, Any]:
    """What the front is drawn against: single precision, a text a column, since the page draws it by itself."""
    largest = np.finfo("<f4").max
    columns = np.clip(data.tried.objectives, -largest, largest).astype("<f4").T
    return {
        "values": [base64.b64encode(column.tobytes()).decode() for column in columns],
        "feasible": base64.b64encode(data.tried.feasible.astype("u1").tobytes()).decode(),
    }


def _first(data: ReportData) -> str | None:
    """The design to begin with: the best whose response is there."""
    known = {response.name for response in data.responses.designs} if data.responses else set()
    ids = [design.design_id for design in data.front]
    return next((name for name in ids if name in known), ids[0] if ids else None)
