"""The figure of step responses: both load flows, the selected designs' beside the thesis's sets."""

from typing import Any

import plotly.graph_objects as go
from plotly.subplots import make_subplots

from divideropt.report.figures import layout, plain
from divideropt.report.palette import OTHERS_STROKE, SELECTED_STROKE, SET_STROKES, Stroke
from divideropt.report.responses import Responses, StepResponse

_WINDOW = 1.25
"""How much longer than the longest of the sets' responses the time axis is."""


def step_figure(responses: Responses) -> go.Figure:
    """Draw the sets' responses, and begin the lines of the selected designs, which the page fills.

    Args:
        responses: What was simulated.

    Returns:
        Two panels over one time axis; last the two lines of the other selected designs, as yet invisible, and the two
        of the design that is shown closely.
    """
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.08)
    figure.update_layout(layout(height=520, margin={"l": 70, "r": 16, "t": 12, "b": 52}))
    for response in responses.sets:
        _add(figure, response, SET_STROKES.get(response.name, Stroke("#808080", "dash", 2.0)))
    _add(
        figure,
        StepResponse("others", (), ((), ()), 0.0),
        OTHERS_STROKE,
        visible=False,
        hoverinfo="skip",
        opacity=0.45,
    )
    _add(figure, StepResponse("selected", (), ((), ()), 0.0), SELECTED_STROKE)
    figure.update_yaxes(title_text="load flow 1 QL1 [L/min]", row=1, col=1)
    figure.update_yaxes(title_text="load flow 2 QL2 [L/min]", row=2, col=1)
    figure.update_xaxes(title_text="time since the first event t [ms]", row=2, col=1)
    figure.update_layout(
        showlegend=True,
        legend={"orientation": "h", "y": 1.02, "yanchor": "bottom", "x": 0, "xanchor": "left"},
        hovermode="x unified",
    )
    return figure


def step_window(response: StepResponse, sets: tuple[StepResponse, ...]) -> float:
    """How long after the step there is something to see [ms]."""
    return min(_WINDOW * max(r.busy for r in (response, *sets)), response.times[-1])


def _add(figure: go.Figure, response: StepResponse, stroke: Stroke, **more: Any) -> None:
    for row, flow in enumerate(response.flows, start=1):
        trace: dict[str, Any] = {
            "x": response.times,
            "y": flow,
            "name": plain(response.name),
            "legendgroup": plain(response.name),
            "showlegend": row == 1,
            "mode": "lines",
            "line": {"color": stroke.colour, "dash": stroke.dash, "width": stroke.width},
            "hovertemplate": "%{y:.4~g} L/min",
        } | more
        figure.add_scatter(**trace, row=row, col=1)
