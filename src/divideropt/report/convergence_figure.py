"""The figures of convergence: every run thin, a strategy's median bold, its spread about it."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go

from divideropt.analysis import Course
from divideropt.report.convergence import Line, Track
from divideropt.report.display import grouped, rounded
from divideropt.report.figures import layout, plain
from divideropt.report.palette import marks

EARLY, EARLY_SHARE = 20, 0.01
"""So many evaluations, or this share of a run's where that is more, find what says little: later all of every line is
within the axis."""

STEPS = "hv"
"""A value holds until the next look at the run: what is between two looks is not made up."""

MARGIN = 0.06
"""Of the axis, above and below the lines."""

BAND = 0.3
"""Opacity of a band, beside plotly's own half."""


def convergence_figure(track: Track, strategies: Sequence[str]) -> go.Figure:
    """Draw a figure of merit over the evaluations, which are on a logarithmic axis; colours are the strategies'."""
    figure = go.Figure(layout=layout(height=400, margin={"l": 64, "r": 16, "t": 12, "b": 52}))
    style = marks(strategies)
    for strategy, course in track.courses.items():
        colour, lines = style[strategy].colour, [line for line in track.lines if line.strategy == strategy]
        for trace in (*_spread(course, colour), *(_run(line, colour) for line in lines if course.runs > 1)):
            figure.add_trace(trace.update(legendgroup=plain(strategy)))
        figure.add_trace(_median(strategy, course, lines, colour))
    figure.update_xaxes(title_text="evaluations of a run", type="log", **_across(track))
    figure.update_yaxes(title_text=plain(track.title), range=_window(track))
    figure.update_layout(
        showlegend=True, legend={"orientation": "h", "y": 1.02, "yanchor": "bottom", "x": 0, "xanchor": "left"}
    )
    return figure


def _run(line: Line, colour: str) -> go.Scatter:
    return go.Scatter(
        x=list(line.marks),
        y=[_drawable(value) for value in line.values],
        name=plain(line.run),
        mode="lines",
        opacity=0.6,
        line={"color": colour, "width": 1, "shape": STEPS},
        showlegend=False,
        hovertemplate=f"{plain(line.run)}<br>%{{x}} evaluations<br>%{{y:.4~g}}<extra></extra>",
    )


def _median(strategy: str, course: Course, lines: Sequence[Line], colour: str) -> go.Scatter:
    """The median of several runs, or the only one."""
    single = course.runs == 1
    x, y = (lines[0].marks, lines[0].values) if single else (course.marks, course.median)
    words = plain(lines[0].run if single else f"{strategy}, median of {course.runs} runs")
    return go.Scatter(
        x=list(x),
        y=[_drawable(value) for value in y],
        name=plain(f"{strategy}, one run") if single else words,
        mode="lines",
        line={"color": colour, "width": 3, "shape": STEPS},
        legendgroup=plain(strategy),
        hovertemplate=f"{words}<br>%{{x}} evaluations<br>%{{y:.4~g}}<extra></extra>",
    )


def _spread(course: Course, colour: str) -> Iterator[go.Scatter]:
    """A band between the quartiles; of few runs, their least and greatest, dashed; of two these are the runs."""
    known = [(x, a, b) for x, a, b in zip(course.marks, course.lower, course.upper, strict=True) if _finite(a, b)]
    if course.runs < 3 or not known:
        return
    marks, lower, upper = (np.array([rounded(value) for value in column]) for column in zip(*known, strict=True))
    quiet = {"mode": "lines", "showlegend": False, "hoverinfo": "skip"}
    if course.quartiles:
        x = np.repeat(marks, 2)[1:]  # steps, as the lines have
        below, above = np.repeat(lower, 2)[:-1], np.repeat(upper, 2)[:-1]
        outline = {"x": np.concatenate([x, x[::-1]]), "y": np.concatenate([below, above[::-1]])}
        yield go.Scatter(**outline, **quiet, fill="toself", opacity=BAND, line={"color": colour, "width": 0})
    else:
        for edge in (lower, upper):
            yield go.Scatter(
                x=marks, y=edge, **quiet, line={"color": colour, "width": 1.5, "dash": "dash", "shape": STEPS}
            )


def _across(track: Track) -> dict[str, Any]:
    """The axis of the evaluations: from where it gets interesting, decades apart, or finer where it has few."""
    longest = max(line.marks[-1] for line in track.lines)
    first = min(EARLY / 4, max(1.0, longest / 10))
    steps = (1,) if longest / first > 300 else (1, 2, 5)
    ticks = [s * 10**k for k in range(10) for s in steps if first <= s * 10**k <= longest]
    ends = [math.log10(first), math.log10(longest * 1.02)]
    return {"range": ends, "tickvals": ticks, "ticktext": [grouped(tick) for tick in ticks]}


def _window(track: Track) -> list[float] | None:
    """The axis: what every run had reached after the first evaluations, and later."""
    seen = [
        value
        for line in track.lines
        for mark, value in zip(line.marks, line.values, strict=True)
        if _finite(value) and mark >= min(max(EARLY, EARLY_SHARE * line.marks[-1]), line.marks[-1])
    ]
    if not seen:
        return None
    room = MARGIN * (max(seen) - min(seen)) or 0.1 * abs(seen[0]) or 0.1
    return [rounded(min(seen) - room), rounded(max(seen) + room)]


def _finite(*values: float) -> bool:
    return all(math.isfinite(value) for value in values)


def _drawable(value: float) -> float | None:
    return rounded(value) if _finite(value) else None
