"""A page with one response: each quantity over time, a plot a unit."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import plotly.graph_objects as go
from plotly.subplots import make_subplots

from divideropt.campaign.simulate import COLUMNS, SimulatedResponse
from divideropt.report.display import Shown, rounded, shown_as
from divideropt.report.document import drawn, render, save
from divideropt.report.figures import layout, plain
from divideropt.report.palette import COLOURS, DASHES

DRAWN = (
    "load_flow_1",
    "load_flow_2",
    *(name for name, unit in COLUMNS.items() if unit == "Pa"),
    "spool_displacement",
)
"""What of a simulated response is drawn, flows first: the answer before the reasons."""

_PLOT_HEIGHT = 260
_TITLES = {"m^3/s": "flow Q", "Pa": "pressure P", "m": "position x", "m/s": "velocity ẋ"}


@dataclass(frozen=True)
class Curve:
    """One quantity over time.

    Attributes:
        name: Its name, `load_flow_1` say.
        unit: The platform's unit: "m^3/s", "Pa", "m", …; curves of one unit share a plot.
        values: As many as there are times, in that unit.
        symbol: Symbol beside the name, "" if it has none.
    """

    name: str
    unit: str
    values: Sequence[float]
    symbol: str = ""


@dataclass(frozen=True)
class ResponseCurves:
    """A response.

    Attributes:
        times: [s].
        curves: The quantities, plotted in the order in which their units appear.
    """

    times: Sequence[float]
    curves: tuple[Curve, ...]


def response_page(title: str, curves: ResponseCurves) -> str:
    """Make a self-contained HTML page of one response.

    Args:
        title: Its heading.
        curves: What to draw: load flows, pressures, spool position, say.

    Returns:
        The page; the same for the same input.

    Raises:
        ValueError: A curve has not as many values as there are times.
    """
    for curve in curves.curves:
        if len(curve.values) != len(curves.times):
            raise ValueError(
                f"{curve.name} has {len(curve.values)} values for {len(curves.times)} times; give one a time"
            )
    figures = [drawn("curves", response_figure(curves))]
    return render("response.html.j2", {"figures": figures}, title=title, curves=curves.curves)


def write_response(response: SimulatedResponse, out: Path) -> Path:
    """Write the page of a simulated response: load flows, pressures, spool displacement.

    Args:
        response: What was simulated.
        out: Where to.

    Returns:
        Where it is.

    Raises:
        DiskError: The disk refused.
    """
    verdict = " ".join(part for part in (str(response.verdict.outcome), response.verdict.text) if part)
    return save(out, response_page(f"Response: {verdict}", curves_of(response)))


def curves_of(response: SimulatedResponse) -> ResponseCurves:
    """Choose what of a simulated response is drawn: load flows, pressures, spool displacement."""
    table = response.table
    curves = tuple(Curve(name, COLUMNS[name], table[name].tolist()) for name in DRAWN)
    return ResponseCurves(table["time"].tolist(), curves)


def response_figure(response: ResponseCurves) -> go.Figure:
    """Draw a response: a plot a unit, over one axis of time."""
    units = list(dict.fromkeys(curve.unit for curve in response.curves))
    rows = max(1, len(units))
    figure = make_subplots(rows=rows, cols=1, shared_xaxes=True, vertical_spacing=0.25 / rows)
    height = 90 + _PLOT_HEIGHT * rows
    figure.update_layout(layout(height=height, margin={"l": 76, "r": 16, "t": 12, "b": 52}))
    time = shown_as("s", response.times)
    for row, unit in enumerate(units, start=1):
        together = [curve for curve in response.curves if curve.unit == unit]
        shown = shown_as(unit, [value for curve in together for value in curve.values])
        name = f"legend{row if row > 1 else ''}"
        for i, curve in enumerate(together):
            figure.add_scatter(**_trace(response.times, curve, time, shown, i), legend=name, row=row, col=1)
        words = _TITLES.get(unit, "")
        figure.update_yaxes(title_text=f"{words} [{plain(shown.unit)}]" if shown.unit else words, row=row, col=1)
        top = figure.layout[f"yaxis{row if row > 1 else ''}"].domain[1]
        figure.update_layout({name: {"orientation": "h", "x": 0, "y": top, "yanchor": "bottom"}})
    figure.update_xaxes(title_text=f"time t [{time.unit}]", row=rows, col=1)
    figure.update_layout(showlegend=True, hovermode="x unified")
    return figure


def _trace(times: Sequence[float], curve: Curve, time: Shown, shown: Shown, place: int) -> dict[str, Any]:
    label = " ".join(part for part in (curve.name.replace("_", " "), curve.symbol) if part)
    return {
        "x": [rounded(t * time.scale, 7) for t in times],
        "y": [rounded(v * shown.scale) if v == v else None for v in curve.values],  # noqa: PLR0124 (NaN)
        "name": plain(label),
        "mode": "lines",
        "line": {
            "color": COLOURS[place % len(COLOURS)],
            "dash": DASHES[(place + place // len(COLOURS)) % len(DASHES)],
            "width": 2,
        },
        "hovertemplate": f"%{{y:.4~g}} {plain(shown.unit)}",
    }
