"""Anytime curves of the valve as pictures, for a light and for a dark page: plotly's, as Chromium draws them."""

import math
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
from playwright.sync_api import sync_playwright
from plotly.subplots import make_subplots

from divideropt.models.base import FloatArray
from divideropt.report.palette import COLOURS, DASHES

WIDTH, HEIGHT = 1080, 600

PAPER = {"light": ("#ffffff", "#1c2430", "#e1e5eb"), "dark": ("#14181e", "#e4e8ee", "#2b323c")}
"""Background, ink and grid."""

DARK_COLOURS = ("#4a9fe0", "#f07f35", "#2cc39a", "#e39bc4", "#f0b93c", "#9ad6f7")
"""`COLOURS` for a dark page, as the report has them."""

BAND = 0.16
"""Opacity of a quartile band."""

LEAST, MOST = 0.02, 30.0
"""Deficits drawn [%]."""

Curves = tuple[FloatArray, FloatArray, Mapping[str, tuple[FloatArray, FloatArray]]]
"""See `Contest.histories`."""


def draw(curves: Curves, best: float, folder: Path) -> Iterator[Path]:
    """Draw what each player lacks after so many evaluations, and after so many seconds.

    Args:
        curves: Of the contest.
        best: The hypervolume of all runs' archives together, from which the deficit is taken.
        folder: Where the pictures go.

    Yields:
        The pictures' paths.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as at:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT}, device_scale_factor=1.5)
        for kind in PAPER:
            document, picture = Path(at, f"{kind}.html"), folder / f"anytime_{kind}.png"
            style = f"<style>body {{margin: 0; background: {PAPER[kind][0]}}}</style>"
            document.write_text(style + _figure(curves, best, kind).to_html(config={"staticPlot": True}), "utf-8")
            page.goto(document.as_uri())
            page.wait_for_selector(".js-plotly-plot .legend")
            page.screenshot(path=picture)
            yield picture
        browser.close()


def _figure(curves: Curves, best: float, kind: str) -> Any:
    paper, ink, grid = PAPER[kind]
    counts, seconds, of = curves
    fig = make_subplots(cols=2, shared_yaxes=True, horizontal_spacing=0.03)
    for place, (player, found) in enumerate(of.items()):
        colour = (COLOURS if kind == "light" else DARK_COLOURS)[place % len(COLOURS)]
        dash = DASHES[place // len(COLOURS)]
        for column, (x, hypervolumes) in enumerate(zip((counts, seconds), found, strict=True), start=1):
            lacking = np.maximum((1.0 - hypervolumes / best) * 100.0, LEAST)
            complete = np.isfinite(lacking).all(axis=0)
            if complete.any():
                quartiles = np.quantile(lacking[:, complete], [0.25, 0.5, 0.75], axis=0)
                for trace in _traces(player, x[complete], quartiles, colour, dash, first=place == 0):
                    fig.add_trace(trace.update(showlegend=trace.showlegend and column == 1), 1, column)
    axis = {
        "type": "log",
        "gridcolor": grid,
        "linecolor": grid,
        "zeroline": False,
        "minor": {"ticks": "inside", "tickcolor": grid},
    }
    fig.update_xaxes(**axis, dtick=1)
    fig.update_xaxes(title_text="evaluations", col=1)
    fig.update_xaxes(title_text="seconds of the processor", col=2)
    fig.update_yaxes(**axis, dtick=1, range=[math.log10(LEAST), math.log10(MOST)])
    fig.update_yaxes(title_text="hypervolume lacking [%]", col=1)
    fig.update_layout(
        width=WIDTH, height=HEIGHT, paper_bgcolor=paper, plot_bgcolor=paper, font={"color": ink, "size": 14},
        margin={"l": 70, "r": 20, "t": 20, "b": 60}, legend={"bgcolor": "rgba(0,0,0,0)"},
    )  # fmt: skip
    return fig


def _traces(player: str, x: FloatArray, quartiles: FloatArray, colour: str, dash: str, first: bool) -> Iterator[Any]:
    """Give the band between the quartiles and the median, the champion's boldest."""
    low, middle, high = quartiles
    yield go.Scatter(
        x=np.concatenate([x, x[::-1]]), y=np.concatenate([low, high[::-1]]), fill="toself", fillcolor=colour,
        opacity=BAND, line={"width": 0}, mode="lines", showlegend=False, hoverinfo="skip",
    )  # fmt: skip
    line = {"color": colour, "dash": dash, "width": 3.5 if first else 1.8}
    yield go.Scatter(x=x, y=middle, name=player, mode="lines", line=line, showlegend=True)
