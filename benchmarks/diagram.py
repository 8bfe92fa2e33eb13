"""Work–precision diagrams as pictures, for a light and for a dark page: plotly's, as Chromium draws them."""

import shutil
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import plotly.graph_objects as go
from playwright.sync_api import sync_playwright
from plotly.subplots import make_subplots

from divideropt.models.base import FloatArray
from divideropt.report.palette import COLOURS

WIDTH, HEIGHT = 1080, 560

PAPER = {"light": ("#ffffff", "#1c2430", "#e1e5eb"), "dark": ("#14181e", "#e4e8ee", "#2b323c")}
"""Background, ink and grid."""

DARK_COLOURS = ("#4a9fe0", "#f07f35", "#2cc39a", "#e39bc4", "#f0b93c", "#9ad6f7")
"""`COLOURS` for a dark page, as the report has them."""

OTHERS = {"light": "#6b7685", "dark": "#9aa5b3"}
"""What is not compared as a method of ours is grey, told apart by dashes."""

DASHES = ("dash", "dot", "dashdot")
SYMBOLS = ("circle", "diamond", "square", "cross", "x", "triangle-up", "circle-open", "diamond-open", "square-open")


@dataclass(frozen=True)
class Curve:
    """A method.

    Attributes:
        name: In the legend; the first curve is drawn boldest.
        worst: Deviations, shape (n,).
        median: Deviations, shape (n,).
        share: Times, shape (n,).
        coloured: Whether it has a colour of its own.
    """

    name: str
    worst: FloatArray
    median: FloatArray
    share: FloatArray
    coloured: bool


def draw(curves: Sequence[Curve], folder: Path, wanted: tuple[float, float]) -> Iterator[Path]:
    """Draw time against worst and median deviation, once for each kind of page.

    Args:
        curves: At most six of them coloured.
        folder: Where the pictures go.
        wanted: Deviations that are marked, worst and median.

    Yields:
        The pictures' paths.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as at:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT}, device_scale_factor=1.5)
        for kind in PAPER:
            document, picture = Path(at, f"{kind}.html"), folder / f"work_precision_{kind}.png"
            style = f"<style>body {{margin: 0; background: {PAPER[kind][0]}}}</style>"
            document.write_text(style + figure(curves, wanted, kind).to_html(config={"staticPlot": True}), "utf-8")
            page.goto(document.as_uri())
            page.wait_for_selector(".js-plotly-plot .legend")
            page.screenshot(path=picture)
            yield picture
        browser.close()


def figure(curves: Sequence[Curve], wanted: tuple[float, float], kind: str) -> Any:
    """Return the figure for one kind of page."""
    paper, ink, grid = PAPER[kind]
    colours = COLOURS if kind == "light" else DARK_COLOURS
    titles = [f"the {what} design; dotted: {off:.0e}" for what, off in zip(("worst", "median"), wanted, strict=True)]
    fig = make_subplots(cols=2, shared_yaxes=True, horizontal_spacing=0.03, subplot_titles=titles)
    grey = 0
    for i, curve in enumerate(curves):
        line = {"color": colours[i], "width": 3.5 if i == 0 else 1.8} if curve.coloured else {
            "color": OTHERS[kind], "width": 1.8, "dash": DASHES[grey]
        }  # fmt: skip
        grey += not curve.coloured
        for column, deviation in enumerate((curve.worst, curve.median), start=1):
            trace = go.Scatter(
                x=deviation, y=curve.share, name=curve.name, line=line, showlegend=column == 1,
                mode="lines+markers", marker={"symbol": SYMBOLS[i], "size": 8 if i == 0 else 7},
            )  # fmt: skip
            fig.add_trace(trace, 1, column)
    for column, value in enumerate(wanted, start=1):
        fig.add_vline(value, line={"color": ink, "width": 1, "dash": "dot"}, row=1, col=column)
    axis = {"type": "log", "gridcolor": grid, "linecolor": grid, "zeroline": False}
    fig.update_xaxes(**axis, exponentformat="power", dtick=1, title_text="relative deviation of the dynamic error")
    fig.update_yaxes(**axis, dtick=1)
    fig.update_yaxes(title_text="time of an integration, in shares of the default's", col=1)
    fig.update_layout(
        width=WIDTH, height=HEIGHT, paper_bgcolor=paper, plot_bgcolor=paper, font={"color": ink, "size": 14},
        margin={"l": 70, "r": 20, "t": 40, "b": 60}, legend={"bgcolor": "rgba(0,0,0,0)"},
    )  # fmt: skip
    return fig
