"""Plotly figures of sweeps: responses for some values, quantities over a parameter, failed designs as marked gaps."""

from collections.abc import Iterable, Mapping, Sequence
from textwrap import wrap
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from divideropt.analysis import Sweep
from divideropt.models.base import FloatArray
from divideropt.report.display import Axis, rounded
from divideropt.report.figures import layout, plain
from divideropt.report.palette import COLOURS, DASHES
from divideropt.report.sweeps_data import DYNAMIC, STEADY, TOTAL, SweepFacts, SweepsData, ValueResponse

WINDOW = 1.5
"""How long after the step the zoom is, in the longest of the settling times: as in changeall.m."""

ZOOM_LEAD = 0.08
"""What of that lies before the step."""

MARGIN = 0.05
"""Above and below the flows in the zoom, in parts of their range."""

MOST_DRAWN = 400
"""Designs of a sweep that a line has, and crosses that mark failed ones, evenly spread; a band marks all of these."""

MOST_NUMBERS = 300_000
"""Numbers of all quantities over all parameters in a page [a number takes ten bytes]."""

COLUMNS = 5
"""Panels in a row."""

FAILED = "failed"
"""Name of the traces that mark failed designs."""

_CROSS = {"color": COLOURS[1], "symbol": "x", "size": 6}
_BAND = {"type": "rect", "layer": "below", "fillcolor": "rgba(128,128,128,0.18)", "line": {"width": 0}}
_LINES = ((STEADY, "steady (3.11)"), (DYNAMIC, "dynamic (3.12)"), (TOTAL, "total"))


def flows_figure(part: SweepFacts) -> go.Figure:
    """Draw the load flows of each response from beginning to end: QL1 thick, QL2 thin."""
    return _responses_figure(part.responses, -np.inf, np.inf)


def step_zoom_figure(part: SweepFacts) -> go.Figure:
    """Draw the same around the step, on the scale of the designs that end well."""
    window = 1e3 * WINDOW * max((r.settling for r in part.responses if r.settling is not None), default=0.0)
    if window <= 0.0:
        return flows_figure(part)
    figure = _responses_figure(part.responses, -ZOOM_LEAD * window, window)
    sound = [r.curve for r in part.responses if r.curve is not None and r.verdict.ok]
    flows = np.concatenate([np.array(c.flows)[:, _around(np.array(c.times), 0.0, window)].ravel() for c in sound])
    margin = MARGIN * float(np.ptp(flows))
    figure.update_xaxes(range=[-ZOOM_LEAD * window, window])
    figure.update_yaxes(range=[float(flows.min()) - margin, float(flows.max()) + margin])
    return figure


def errors_figure(part: SweepFacts) -> go.Figure:
    """Draw steady, dynamic and total error in percent."""
    return _over(part, _LINES, 1.0, "error at t_cum [%]", "%")


def quantity_figure(part: SweepFacts, axis: Axis) -> go.Figure:
    """Draw one quantity."""
    return _over(part, ((axis.name, axis.words),), axis.shown.scale, plain(axis.label), axis.shown.unit)


def panels_figure(data: SweepsData, name: str) -> go.Figure:
    """Draw one quantity over every parameter, a panel each, over one common axis; the page may change which."""
    columns = min(COLUMNS, len(data.parts))
    rows = -(-len(data.parts) // columns)
    figure = make_subplots(
        rows=rows, cols=columns, shared_yaxes="all", vertical_spacing=0.34 / rows, horizontal_spacing=0.02
    )
    figure.update_layout(layout(height=60 + 210 * rows, margin={"l": 64, "r": 12, "t": 12, "b": 52}))
    shapes: list[dict[str, Any]] = []
    numbers = panel_numbers(data)[name]
    for i, part in enumerate(data.parts):
        place = {"row": i // columns + 1, "col": i % columns + 1}
        rows_drawn, failed = _drawn(data, part)
        line, circles, crosses = numbers["y"][3 * i : 3 * i + 3]
        figure.add_scatter(**_line(_shown(part, rows_drawn), line, part.axis.words, 0), **place)
        figure.add_scatter(**_circles(part, failed, circles, 0), **place)
        figure.add_scatter(**_crosses(part, failed, crosses), **place)
        figure.update_xaxes(title_text=plain(_short(part.axis)), range=_range(part), **place)
        suffix = str(i + 1) if i else ""
        shapes += _marks(part, f"x{suffix}", f"y{suffix} domain")
        if place["col"] == 1:
            figure.update_yaxes(title_text=numbers["label"], **place)
    figure.update_yaxes(range=numbers["range"])
    figure.update_layout(shapes=shapes)
    return figure


def panel_numbers(data: SweepsData) -> Mapping[str, Mapping[str, Any]]:
    """Give what the panels show of each quantity: label, range, and of each parameter line, circles and crosses."""
    found = {}
    for name, axis in data.quantities.items():
        low, high = _extent([part.sweep for part in data.parts], [name], axis.shown.scale)
        traces: list[list[float | None]] = []
        for part in data.parts:
            rows, failed = _drawn(data, part)
            traces.append(_numbers(part.sweep.sound(name)[rows] * axis.shown.scale))
            traces.append(_numbers(part.sweep.quantities[name][failed] * axis.shown.scale))
            traces.append(_numbers(np.full(len(failed), low)))
        found[name] = {"label": plain(axis.label), "range": _around_extent(low, high), "y": traces}
    return found


def _responses_figure(responses: Sequence[ValueResponse], begin: float, end: float) -> go.Figure:
    figure = go.Figure(layout=layout(height=380, margin={"l": 62, "r": 12, "t": 12, "b": 52}))
    for i, response in enumerate(responses):
        curve = response.curve
        if curve is None:
            continue
        times = np.array(curve.times)
        kept = _around(times, begin, end)
        name = plain(curve.name if response.verdict.ok else f"{curve.name} ({response.verdict.outcome})")
        for number in (0, 1):
            figure.add_scatter(
                x=times[kept],
                y=np.array(curve.flows[number])[kept],
                name=name,
                legendgroup=name,
                showlegend=number == 0,
                mode="lines",
                line={"color": COLOURS[i % len(COLOURS)], "dash": DASHES[i % len(DASHES)], "width": 2.4 - number},
                hovertemplate=f"{name} QL{number + 1}<br>%{{x:.4~g}} ms<br>%{{y:.4~g}} L/min<extra></extra>",
            )
    figure.update_xaxes(title_text="time since the first event t [ms]")
    figure.update_yaxes(title_text="load flows QL1, QL2 [L/min]")
    figure.update_layout(showlegend=True, legend=_LEGEND)
    return figure


_LEGEND = {"orientation": "h", "y": 1.02, "yanchor": "bottom", "x": 0, "xanchor": "left"}


def _around(times: FloatArray, begin: float, end: float) -> NDArray[np.bool_]:
    """Which points of a line to draw: those in a window, and its neighbours on either side."""
    inside = (times >= begin) & (times <= end)
    kept = inside.copy()
    kept[1:] |= inside[:-1]
    kept[:-1] |= inside[1:]
    return kept


def _over(part: SweepFacts, lines: Sequence[tuple[str, str]], scale: float, title: str, unit: str) -> go.Figure:
    """Draw quantities over a parameter, each by its name and its words."""
    figure = go.Figure(layout=layout(height=320, margin={"l": 62, "r": 12, "t": 12, "b": 52}))
    sweep, failed = part.sweep, _failed(part)
    rows = _thinned(len(sweep.values), MOST_DRAWN)
    low, high = _extent([sweep], [name for name, _ in lines], scale)
    for i, (name, words) in enumerate(lines):
        hover = f"{plain(words)} %{{y:.4~g}} {plain(unit)}<br>{plain(_short(part.axis))} %{{x:.4~g}}<extra></extra>"
        line = _line(_shown(part, rows), _numbers(sweep.sound(name)[rows] * scale), words, i)
        figure.add_scatter(**line | {"hovertemplate": hover})
        if len(failed):
            figure.add_scatter(**_circles(part, failed, _numbers(sweep.quantities[name][failed] * scale), i))
    if len(failed):
        figure.add_scatter(**_crosses(part, failed, _numbers(np.full(len(failed), low))))
    figure.update_xaxes(title_text=plain(part.axis.label), range=_range(part))
    figure.update_yaxes(title_text=title, zeroline=True, range=_around_extent(low, high))
    figure.update_layout(shapes=_marks(part, "x", "paper"))
    if len(lines) > 1 or len(failed):
        figure.update_layout(showlegend=True, legend=_LEGEND)
    return figure


def _line(x: FloatArray, y: Sequence[float | None], words: str, place: int) -> dict[str, Any]:
    """A line that is broken where there is no value; a value between two gaps is a point."""
    return {
        "x": x,
        "y": y,
        "name": plain(words),
        "mode": "lines" if not _alone(y) else "lines+markers",
        "marker": {"color": COLOURS[place], "size": 3},
        "line": {"color": COLOURS[place], "dash": DASHES[place], "width": 2},
        "connectgaps": False,
        "hovertemplate": "%{x:.4~g}<br>%{y:.4~g}<extra></extra>",
    }


def _circles(part: SweepFacts, failed: NDArray[np.intp], y: Sequence[float | None], place: int) -> dict[str, Any]:
    """What a failed design has all the same, where it is defined: no part of the line."""
    return {
        "x": _shown(part, failed),
        "y": y,
        "mode": "markers",
        "marker": {"color": COLOURS[place], "symbol": "circle-open", "size": 5},
        "showlegend": False,
        "hovertemplate": "failed, yet %{y:.4~g}<extra></extra>",
    }


def _crosses(part: SweepFacts, failed: NDArray[np.intp], y: Sequence[float | None]) -> dict[str, Any]:
    """A cross a failed design, with why it failed."""
    verdicts = [part.sweep.verdicts[i] for i in failed.tolist()]
    return {
        "x": _shown(part, failed),
        "y": y,
        "name": FAILED,
        "mode": "markers",
        "marker": _CROSS,
        "cliponaxis": False,
        "text": [_folded(f"{v.outcome}: {v.text}".rstrip(": ")) for v in verdicts],
        "hovertemplate": f"{plain(_short(part.axis))} %{{x:.4~g}}<br>%{{text}}<extra></extra>",
    }


def _marks(part: SweepFacts, xref: str, yref: str) -> list[dict[str, Any]]:
    """A band wherever designs fail, and a dotted line at the campaign's own value."""
    sweep, scale = part.sweep, part.axis.shown.scale
    half = float(np.diff(sweep.values).min()) / 2.0
    ends = sweep.values[[0, -1]]
    bands = [
        _BAND
        | {"xref": xref, "yref": yref, "y0": 0, "y1": 1}
        | {
            f"x{i}": rounded(float(np.clip(at, *ends)) * scale, 7)
            for i, at in enumerate((f.begin - half, f.end + half))
        }
        for f in sweep.failures()
    ]
    if not ends[0] <= sweep.base <= ends[1]:
        return bands
    at = rounded(sweep.base * scale, 7)
    line = {"type": "line", "line": {"dash": "dot", "width": 1.4}, "xref": xref, "yref": yref}
    return [*bands, line | {"x0": at, "x1": at, "y0": 0, "y1": 1}]


def _drawn(data: SweepsData, part: SweepFacts) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows of a sweep that the panels draw as a line, and those that they mark as failed."""
    share = MOST_NUMBERS // max(1, len(data.parts) * len(data.quantities))
    return _thinned(len(part.sweep.values), min(MOST_DRAWN, max(share, 2))), _failed(part)


def _failed(part: SweepFacts) -> NDArray[np.intp]:
    rows = np.flatnonzero(~part.sweep.ok)
    return rows[_thinned(len(rows), MOST_DRAWN)]


def _thinned(count: int, most: int) -> NDArray[np.intp]:
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.intp))


def _shown(part: SweepFacts, rows: NDArray[np.intp]) -> FloatArray:
    return np.array([rounded(part.axis.scaled(v), 7) for v in part.sweep.values[rows].tolist()])


def _numbers(values: FloatArray) -> list[float | None]:
    return [rounded(v) if np.isfinite(v) else None for v in values.tolist()]


def _range(part: SweepFacts) -> list[float]:
    """The whole range of the parameter, and a little more so that its ends are seen."""
    low, high = (part.axis.scaled(float(v)) for v in part.sweep.values[[0, -1]])
    return [low - 0.02 * (high - low), high + 0.02 * (high - low)]


def _extent(sweeps: Sequence[Sweep], names: Sequence[str], scale: float) -> tuple[float, float]:
    """From where failed designs are marked, a little below the rest, to the greatest value.

    The rest is what the designs that ended well have, or where there is none what all have.
    """
    for values in (
        np.concatenate([sweep.sound(name) for sweep in sweeps for name in names]),
        np.concatenate([sweep.quantities[name] for sweep in sweeps for name in names]),
    ):
        known = values[np.isfinite(values)] * scale
        if len(known):
            extent = float(np.ptp(known)) or abs(float(known[0])) or 1.0
            return rounded(float(known.min()) - 0.07 * extent), rounded(float(known.max()))
    return 0.0, 1.0


def _around_extent(low: float, high: float) -> list[float]:
    """The range of an axis: marks and values, and a little more."""
    return [rounded(low - 0.05 * (high - low)), rounded(high + 0.05 * (high - low))]


def _alone(y: Iterable[float | None]) -> bool:
    """Whether some value has none on either side, which a line would not show."""
    known = [False, *(value is not None for value in y), False]
    return any(known[i] and not known[i - 1] and not known[i + 1] for i in range(1, len(known) - 1))


def _short(axis: Axis) -> str:
    return " ".join(part for part in (axis.symbol or axis.words, axis.bracket) if part)


def _folded(text: str, width: int = 60) -> str:
    """Escape a sentence and break it into lines of a hover label."""
    return "<br>".join(plain(line) for line in wrap(text, width))
