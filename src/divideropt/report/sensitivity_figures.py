"""Figures of a sensitivity study: indices, interactions, convergence, failures, elementary effects."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from divideropt.analysis.failures import PARTS, Failures
from divideropt.analysis.treatments import Treatment
from divideropt.models.base import FloatArray
from divideropt.report.display import Axis, Shown, axis_of, labels_of, number, rounded
from divideropt.report.figures import layout, plain
from divideropt.report.palette import COLOURS, DASHES
from divideropt.report.sensitivity_data import StudyData, first_of, quantity_words

COLUMNS = 3
"""Panels in a row."""

INTERVAL = "#8a929c"
"""Colour of intervals: seen on the bars and on either page."""

_SHAPES = ("circle", "diamond", "square", "cross", "x", "triangle-up", "triangle-down", "star", "hexagon", "pentagon")
_PANEL = 250
_WORDS = {"S1": "alone, S1", "ST": "with others, ST"}


def index_bars(
    indices: pd.DataFrame, quantities: Sequence[tuple[str, str]], variables: Sequence[tuple[str, str]]
) -> go.Figure:
    """Draw first-order and total indices with their intervals, a panel a quantity.

    Args:
        indices: A table of indices.
        quantities: Names and words of what is drawn.
        variables: Names and labels of the variables.
    """
    figure = _panels([words for _, words in quantities])
    for place, (quantity, _) in enumerate(quantities):
        for kind, colour in (("ST", COLOURS[0]), ("S1", COLOURS[4])):
            found = first_of(indices, quantity, kind)
            values, half = _values(found, [name for name, _ in variables])
            figure.add_bar(
                x=[plain(label) for _, label in variables],
                y=values,
                error_y={"array": half, "color": INTERVAL, "thickness": 1.5, "width": 4},
                name=_WORDS[kind],
                marker={"color": colour, "pattern": {"shape": "/" if kind == "S1" else "", "solidity": 0.35}},
                legendgroup=kind,
                showlegend=place == 0,
                customdata=half,
                hovertemplate=f"{kind} of %{{x}}: %{{y:.3f}} ± %{{customdata:.3f}}<extra></extra>",
                **_place(place),
            )
    figure.update_layout(barmode="group", bargap=0.25, showlegend=True)
    figure.update_yaxes(rangemode="tozero")
    figure.update_yaxes(title_text="Sobol indices S1, ST", col=1)
    return figure


def convergence(data: StudyData) -> go.Figure:
    """Draw the total indices of the objectives against the blocks they are made from."""
    figure = _panels([quantity_words(name, data.problem) for name in data.objectives])
    table = data.indices[(data.indices["kind"] == "ST")]
    for place, quantity in enumerate(data.objectives):
        chosen = table[table["quantity"] == quantity]
        chosen = chosen[chosen["treatment"].isin([str(Treatment.ALL), str(Treatment.WORKING)])]
        for i, (axis, _, _) in enumerate(data.variables):
            mine = chosen[chosen["variable"] == axis.name].sort_values("samples")
            figure.add_scatter(
                x=mine["samples"].tolist(),
                y=[rounded(v) for v in mine["value"]],
                error_y={"array": [rounded(v) for v in mine["high"] - mine["value"]], "thickness": 1, "width": 3},
                name=plain(axis.words),
                mode="lines+markers",
                line={
                    "color": COLOURS[i % len(COLOURS)],
                    "width": 1.5,
                    "dash": DASHES[i // len(COLOURS) % len(DASHES)],
                },
                marker={"color": COLOURS[i % len(COLOURS)], "symbol": _SHAPES[i % len(_SHAPES)], "size": 6},
                legendgroup=axis.name,
                showlegend=place == 0,
                hovertemplate=f"{plain(axis.words)}<br>%{{x}} blocks: %{{y:.3f}}<extra></extra>",
                **_place(place),
            )
    counts = sorted(set(table["samples"]))
    figure.update_xaxes(type="log", tickvals=counts, ticktext=[_short(count) for count in counts])
    figure.update_xaxes(title_text="blocks")
    figure.update_yaxes(rangemode="tozero")
    figure.update_yaxes(title_text="Sobol index ST", col=1)
    figure.update_layout(showlegend=True)
    return figure


def interactions(data: StudyData) -> go.Figure:
    """Draw the second-order indices of the objectives as a triangle, a panel each."""
    labels = variable_labels(data)
    figure = _panels([quantity_words(name, data.problem) for name in data.objectives])
    places = {name: i for i, (name, _) in enumerate(labels)}
    for place, quantity in enumerate(data.objectives):
        matrix = np.full((len(labels), len(labels)), np.nan)
        words = np.full(matrix.shape, "", dtype=object)
        for row in first_of(data.indices, quantity, "S2").reset_index().to_dict("records"):
            i, j = places[row["variable"]], places[row["with"]]
            matrix[j, i] = row["value"]
            half = row["high"] - row["value"]
            words[j, i] = f"{labels[i][1]} with {labels[j][1]}: {number(row['value'], 3)} ± {number(half, 2)}"
        _heat(figure, matrix, words, [label for _, label in labels], [label for _, label in labels], 0.3, 0, place)
    figure.update_yaxes(autorange="reversed")
    return figure


def failures_figure(failures: Failures, variables: Sequence[tuple[Axis, float, float]]) -> go.Figure:
    """Draw the share that failed by tenth of each variable's range."""
    figure = go.Figure(layout=layout(height=90 + 34 * len(variables), margin={"l": 150, "r": 12, "t": 8, "b": 52}))
    words = np.full(failures.shares.shape, "", dtype=object)
    for i, (axis, lower, upper) in enumerate(variables):
        for k in range(PARTS):
            ends = (lower + (upper - lower) * (k + step) / PARTS for step in (0, 1))
            between = " to ".join(axis.text(end) for end in ends)
            counts = f"{failures.failed[i, k]} of {failures.counts[i, k]}"
            words[i, k] = f"{axis.words} {between} {axis.shown.unit}: {counts}"
    parts = [f"{10 * k}–{10 * (k + 1)} %" for k in range(PARTS)]
    _heat(figure, failures.shares, words, parts, [axis.words for axis, _, _ in variables], 1.0, 1, None)
    figure.update_xaxes(title_text="part of the range, from its lower bound")
    figure.update_yaxes(autorange="reversed")
    return figure


def effects_figure(data: StudyData, quantities: Sequence[str]) -> go.Figure:
    """Draw Morris's σ against μ*, a panel a quantity; on the dotted line they are equal."""
    figure = _panels([quantity_words(name, data.problem) for name in quantities])
    for place, quantity in enumerate(quantities):
        star, sigma = (data.first(quantity, kind) for kind in ("mu_star", "sigma"))
        names = [axis.name for axis, _, _ in data.variables if axis.name in star.index]
        axis = effect_axis(data, quantity, star["value"].tolist())
        x = [rounded(axis.scaled(v)) for v in star.loc[names, "value"]]
        half = star.loc[names, "high"] - star.loc[names, "value"]
        y = [rounded(axis.scaled(v)) for v in sigma.loc[names, "value"]]
        labels = dict(variable_labels(data))
        figure.add_scatter(
            x=x,
            y=y,
            error_x={
                "array": [rounded(axis.scaled(v)) for v in half],
                "color": INTERVAL,
                "thickness": 1.2,
                "width": 3,
            },
            mode="markers+text",
            text=[plain(labels[name]) for name in names],
            textposition="top center",
            cliponaxis=False,
            marker={"color": COLOURS[0], "size": 8},
            hovertemplate="%{text}<br>μ* %{x:.4~g}, σ %{y:.4~g}<extra></extra>",
            **_place(place),
        )
        end = max([*x, *y], default=1.0)
        number_ = "" if place == 0 else str(place + 1)
        figure.add_shape(
            type="line",
            x0=0,
            y0=0,
            x1=end,
            y1=end,
            xref=f"x{number_}",
            yref=f"y{number_}",
            line={"dash": "dot", "width": 1},
        )
        unit = f" [{plain(axis.shown.unit)}]" if axis.shown.unit else ""
        figure.update_xaxes(title_text=f"μ*{unit}", rangemode="tozero", **_place(place))
        top = 1.15 * max(y, default=0.0)  # room for the label of the highest
        figure.update_yaxes(title_text=f"σ{unit}", range=[0.0, top] if top > 0.0 else None, **_place(place))
        figure.update_yaxes(rangemode="tozero", **_place(place))
    return figure


def effect_axis(data: StudyData, quantity: str, values: Sequence[float]) -> Axis:
    """How effects on a quantity are shown; on the outcome as a number."""
    entry = data.problem.model.quantities.get(quantity)
    return Axis(quantity, "outcome ok", "", "", Shown("", 1.0)) if entry is None else axis_of(entry, values)


def variable_labels(data: StudyData) -> list[tuple[str, str]]:
    """Names of the variables, and what they are called in a figure: the symbol where there is one."""
    axes = [axis for axis, _, _ in data.variables]
    return list(zip([axis.name for axis in axes], labels_of(axes), strict=True))


def _panels(titles: Sequence[str]) -> go.Figure:
    columns = min(COLUMNS, max(1, len(titles)))
    rows = max(1, -(-len(titles) // columns))
    figure = make_subplots(
        rows=rows,
        cols=columns,
        subplot_titles=[plain(title) for title in titles],
        vertical_spacing=min(0.3, 0.3 / rows),
        horizontal_spacing=0.07,
    )
    margin = {"l": 56, "r": 16, "t": 64, "b": 52}
    figure.update_layout(layout(height=116 + _PANEL * rows, margin=margin))
    height = _PANEL * rows
    above = {"orientation": "h", "y": 1 + 30 / height, "yanchor": "bottom", "x": 0, "xanchor": "left"}
    figure.update_layout(legend=above)
    figure.update_annotations(font={"size": 13})
    return figure


def _place(place: int) -> dict[str, int]:
    return {"row": place // COLUMNS + 1, "col": place % COLUMNS + 1}


def _heat(
    figure: go.Figure,
    values: FloatArray,
    words: Any,
    columns: Sequence[str],
    rows: Sequence[str],
    least_end: float,
    colour: int,
    place: int | None,
) -> None:
    """Add a heat map whose colour is transparent at 0, so that the page's ink reads on it in either theme."""
    end = float(np.nanmax(values, initial=least_end))
    red, green, blue = (int(COLOURS[colour][k : k + 2], 16) for k in (1, 3, 5))
    scale = [[0.0, f"rgba({red},{green},{blue},0)"], [1.0, f"rgba({red},{green},{blue},0.6)"]]
    where = {} if place is None else _place(place)
    figure.add_heatmap(
        z=[[None if v != v else rounded(v) for v in row] for row in values.tolist()],  # noqa: PLR0124 (NaN)
        x=[plain(label) for label in columns],
        y=[plain(label) for label in rows],
        zmin=0.0,
        zmax=end,
        colorscale=scale,
        showscale=False,
        hoverongaps=False,
        xgap=1,
        ygap=1,
        customdata=[[plain(text) for text in row] for row in words.tolist()],
        hovertemplate="%{customdata}<extra></extra>",
        **where,
    )
    percent, known = place is None, np.argwhere(np.isfinite(values)).tolist()
    shown = [values[i, j] for i, j in known]
    figure.add_scatter(  # one trace: a figure of annotations takes minutes where variables are many
        x=[plain(columns[j]) for _, j in known],
        y=[plain(rows[i]) for i, _ in known],
        mode="text",
        text=[f"{100 * value:.0f} %" if percent else f"{value:.2f}".replace("-", "−") for value in shown],
        textfont={"size": 11},
        hoverinfo="skip",
        showlegend=False,
        **where,
    )
    figure.update_xaxes(showgrid=False, **where)
    figure.update_yaxes(showgrid=False, **where)


def _values(found: pd.DataFrame, names: Sequence[str]) -> tuple[list[float | None], list[float | None]]:
    """Values and half widths by variable, None where there is none."""
    known = found.to_dict("index")
    values = [rounded(known[name]["value"]) if name in known else None for name in names]
    half = [rounded(known[name]["high"] - known[name]["value"]) if name in known else None for name in names]
    return values, half


def _short(count: int) -> str:
    return f"{count // 1024}k" if count >= 1024 and count % 1024 == 0 else str(count)
