"""Which Plotly a page carries: the part that draws points and lines in two and three dimensions, or all of it."""

from collections.abc import Iterable
from functools import cache
from importlib.resources import files

from plotly.offline import get_plotlyjs

PART = "plotly-gl3d.min.js"
"""The file of the package `plotly.js-gl3d-dist-min` 4.1.1 on npm, as it was published, under its MIT licence."""

PART_DIGEST = "aab04dcd9c103a92b18723f8c837712fe820f325d0bcd2421e415e8124a75b9f"
"""Its SHA-256."""

PART_DRAWS = frozenset({"scatter", "scatter3d"})
"""Kinds of traces, by plotly's names, for which the part is enough."""


def plotly_for(kinds: Iterable[str]) -> str:
    """Return the script that draws traces of such kinds: of 1.8 MB where it is enough, else of 4.8 MB.

    A browser compiles an inline script anew at each opening: its size is much of the time until a page is drawn.
    """
    return _part() if set(kinds) <= PART_DRAWS else get_plotlyjs()


@cache
def _part() -> str:
    return files("divideropt.report").joinpath("plotly", PART).read_text("utf-8")
