"""The figure of strategies compared: a panel a figure of merit, a point a run."""

import plotly.graph_objects as go
from plotly.subplots import make_subplots

from divideropt.analysis import INDICATORS, Comparison
from divideropt.report.comparison import quartiles
from divideropt.report.display import rounded
from divideropt.report.figures import layout, plain
from divideropt.report.palette import marks

COLUMNS = 3
"""Panels in a row."""

SPREAD = 0.25
"""Half the width over which a strategy's runs are drawn side by side, so that equal ones are seen."""


def comparison_figure(comparison: Comparison) -> go.Figure:
    """Draw what each run reached, and the median of each strategy; infinite values are left out."""
    shown = [name for name in INDICATORS if any(s.values[name] is not None for s in comparison.scores)]
    rows = -(-len(shown) // COLUMNS)
    titles = [
        f"{plain(INDICATORS[n].title)} ({'more' if INDICATORS[n].sign > 0 else 'less'} is better)" for n in shown
    ]
    figure = make_subplots(rows=rows, cols=COLUMNS, subplot_titles=titles, vertical_spacing=0.3 / rows)
    figure.update_layout(layout(height=60 + 240 * rows, margin={"l": 56, "r": 12, "t": 36, "b": 36}))
    groups = comparison.groups
    style = marks(list(groups))
    for place, indicator in enumerate(shown):
        row, column = place // COLUMNS + 1, place % COLUMNS + 1
        for x, (name, scores) in enumerate(groups.items()):
            values = [value for score in scores if (value := score.values[indicator]) is not None]
            step = 2 * SPREAD / max(1, len(values) - 1) if len(values) > 1 else 0.0
            first = x - SPREAD if len(values) > 1 else float(x)
            figure.add_scatter(
                x=[first + i * step for i in range(len(values))],
                y=[_drawable(value) for value in values],
                mode="markers",
                marker={"color": style[name].colour, "symbol": style[name].shape, "size": 7, "opacity": 0.8},
                text=[plain(score.run) for score in scores],
                hovertemplate="%{text}<br>%{y:.4~g}<extra></extra>",
                row=row,
                col=column,
            )
            middle = quartiles(indicator, scores)
            median = None if middle is None else _drawable(middle[1])
            figure.add_scatter(
                x=[x - 0.38, x + 0.38],
                y=[median, median],
                mode="lines",
                line={"color": style[name].colour, "width": 2},
                hoverinfo="skip",
                row=row,
                col=column,
            )
        ticks = {"tickvals": list(range(len(groups))), "ticktext": [plain(name) for name in groups]}
        figure.update_xaxes(**ticks, range=[-0.6, len(groups) - 0.4], showgrid=False, row=row, col=column)
    return figure


def _drawable(value: float) -> float | None:
    return rounded(value) if abs(value) < float("inf") else None
