"""Plotly figures of the front. Colours of text and grids are the page's, which knows the theme."""

import html
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from divideropt.models.base import FloatArray
from divideropt.report.data import ReportData
from divideropt.report.display import rounded
from divideropt.report.facts import ObjectiveFacts
from divideropt.report.front import Design
from divideropt.report.palette import Mark, marks

MOST_PROJECTIONS = 6
"""Pairs of objectives that are drawn: all of up to four objectives."""

SELECTION = "selected"
"""Name of the trace that rings the selected design; the page fills it."""

CHOSEN = "chosen"
"""Name of the trace of the selected designs in three dimensions, where a trace has one opacity; the page fills it."""

SMALLEST = 1e-12
"""Residuals are drawn no lower, where the axis would have no place for zero."""

MANY = 1500
"""Designs from which on the marks of a projection are smaller."""

MARGIN = 0.05
"""Room between the outermost points and the frame, in shares of the front's extent."""

BEHIND = 0.35
"""How far the axes go beyond the front, where something was tried there, in shares of its extent."""

HOVER = "<b>%{customdata}</b><br>%{text}<extra></extra>"
"""What is shown of a point under the pointer: its design, and its objectives as the page's script writes numbers."""

FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Liberation Sans', sans-serif"
"""Fonts that are there: none is fetched."""


def front_3d(data: ReportData) -> go.Figure:
    """Draw the front in its first three objectives."""
    first = data.objectives[:3]
    figure = go.Figure(layout=layout(height=540, margin={"l": 0, "r": 0, "t": 0, "b": 0}))
    for name, mark, designs in _by_strategy(data):
        places = dict(zip("xyz", _columns(designs, first), strict=True))
        figure.add_scatter3d(
            **places,
            name=name,
            mode="markers",
            marker={"color": mark.colour, "symbol": mark.shape, "size": 4, "opacity": mark.opacity},
            customdata=_ids(designs),
            hovertemplate=HOVER,
        )
    figure.add_scatter3d(
        x=[],
        y=[],
        z=[],
        name=CHOSEN,
        mode="markers",
        marker={"size": 5},
        customdata=[],
        hovertemplate=HOVER,
    )
    figure.add_scatter3d(**ring(12), x=[], y=[], z=[])
    axes = {f"{k}axis": {"title": {"text": label(o)}} for k, o in zip("xyz", first, strict=True)}
    figure.update_layout(
        scene=axes
        | {
            "aspectmode": "cube",
            "camera": {"eye": {"x": 1.45, "y": 1.45, "z": 0.75}, "center": {"x": 0, "y": 0, "z": -0.17}},
        }
    )
    return figure


def projections(data: ReportData) -> list[tuple[tuple[int, int], go.Figure]]:
    """Draw the front on pairs of objectives: the pair, and its figure."""
    pairs = list(combinations(range(len(data.objectives)), 2))[:MOST_PROJECTIONS]
    return [(pair, _projection(data, data.objectives[pair[0]], data.objectives[pair[1]])) for pair in pairs]


def residuals(data: ReportData) -> go.Figure:
    """Draw how the KKT residuals of each strategy's designs on the front are distributed."""
    figure = go.Figure(layout=layout(height=340, margin={"l": 64, "r": 16, "t": 12, "b": 52}))
    for name, mark in marks(data.strategies).items():
        found = [d.optimality for d in data.front if d.strategy == name and d.optimality is not None]
        if not found:
            continue
        values = np.sort([max(item.residual, item.floor, SMALLEST) for item in found])
        figure.add_scatter(
            x=np.array([rounded(value) for value in values]),
            y=np.arange(1, len(values) + 1) / len(values),
            name=plain(name),
            mode="lines",
            line={"color": mark.colour, "width": 2, "shape": "hv"},
            hovertemplate=f"{plain(name)}<br>%{{y:.0%}} at most %{{x:.2~e}}<extra></extra>",
        )
    figure.update_xaxes(title_text="KKT residual", type="log", exponentformat="power", dtick=1)
    figure.update_yaxes(title_text="share of designs", range=[0, 1.02], tickformat=".0%")
    figure.update_layout(
        showlegend=True, legend={"orientation": "h", "y": 1.02, "yanchor": "bottom", "x": 0, "xanchor": "left"}
    )
    return figure


def label(facts: ObjectiveFacts) -> str:
    """Label an axis, escaped: plotly reads tags, and links among them, in any text."""
    return plain(facts.axis.label)


def plain(text: str) -> str:
    """Escape a text for plotly, which reads tags in any text, and `%{…}` in the template of a hover label."""
    return html.escape(text, quote=False).replace("%{", "%&#123;")


def layout(height: int, margin: dict[str, int]) -> dict[str, Any]:
    """Begin a layout: transparent, so that the page's colours show."""
    return {
        "template": "none",
        "height": height,
        "margin": margin,
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "font": {"family": FONT, "size": 12},
        "hovermode": "closest",
        "showlegend": False,
        "uirevision": "kept",
    }


def _projection(data: ReportData, first: ObjectiveFacts, second: ObjectiveFacts) -> go.Figure:
    figure = go.Figure(layout=layout(height=340, margin={"l": 62, "r": 12, "t": 12, "b": 52}))
    for name, mark, designs in _by_strategy(data):
        x, y = _columns(designs, (first, second))
        figure.add_scatter(
            x=x,
            y=y,
            name=name,
            mode="markers",
            marker={
                "color": mark.colour,
                "symbol": mark.shape,
                "size": 6 if len(data.drawn) < MANY else 4,
                "opacity": mark.opacity,
            },
            customdata=_ids(designs),
            hovertemplate=HOVER,
        )
    figure.add_scatter(**ring(13), x=[], y=[])
    figure.update_xaxes(title_text=label(first), range=_range(data, first))
    figure.update_yaxes(title_text=label(second), range=_range(data, second))
    figure.update_layout(shapes=list(goal_lines(first, second)), dragmode="select")
    return figure


def _range(data: ReportData, facts: ObjectiveFacts) -> list[float]:
    """What an axis shows at first: the front, the goal, and of what was tried what is not far behind."""
    values = [data.front[i].objectives[facts.index] for i in data.drawn]
    values += [] if facts.goal is None else [facts.goal]
    low, high = min(values), max(values)
    wide = (high - low) or abs(high) or 1.0
    worst = data.tried.objectives[:, facts.index].max(initial=high)
    top = min(worst, high + BEHIND * wide)
    return [rounded(facts.axis.scaled(low - MARGIN * wide)), rounded(facts.axis.scaled(top + MARGIN * wide))]


def goal_lines(first: ObjectiveFacts, second: ObjectiveFacts) -> Iterator[dict[str, Any]]:
    """Lines at the goals of two objectives, as far as there are any."""
    style = {"type": "line", "line": {"dash": "dot", "width": 1.4}}
    if first.goal is not None:
        at = first.axis.scaled(first.goal)
        yield style | {"x0": at, "x1": at, "y0": 0, "y1": 1, "yref": "paper"}
    if second.goal is not None:
        at = second.axis.scaled(second.goal)
        yield style | {"y0": at, "y1": at, "x0": 0, "x1": 1, "xref": "paper"}


def _by_strategy(data: ReportData) -> Iterator[tuple[str, Mark, list[Design]]]:
    """The strategies with designs to draw, in order."""
    drawn = [data.front[i] for i in data.drawn]
    for name, mark in marks(data.strategies).items():
        designs = [design for design in drawn if design.strategy == name]
        if designs:
            yield plain(name), mark, designs


def _columns(designs: Sequence[Design], objectives: Sequence[ObjectiveFacts]) -> list[FloatArray]:
    """Values of some objectives, as shown; in arrays, which plotly takes as they are: it looks through lists."""
    return [
        np.array([rounded(facts.axis.scaled(design.objectives[facts.index])) for design in designs])
        for facts in objectives
    ]


def _ids(designs: Sequence[Design]) -> NDArray[np.object_]:
    return np.array([plain(design.design_id) for design in designs], dtype=object)


def ring(size: float) -> dict[str, Any]:
    """Begin the trace that rings the selected design."""
    return {
        "name": SELECTION,
        "mode": "markers",
        "marker": {"symbol": "circle-open", "size": size, "line": {"width": 2.5}},
        "hoverinfo": "skip",
    }
