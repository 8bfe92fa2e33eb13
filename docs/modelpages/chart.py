"""Line charts as SVG, written by hand so that the same data gives the same bytes.

The paper is opaque and turns dark with the reader's browser, so a chart can be read on any page.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape

from divideropt.models.base import FloatArray
from divideropt.report.palette import COLOURS
from modelpages.axis import Axis

DARK_COLOURS = ("#4a9fe0", "#f07f35", "#2cc39a", "#e39bc4", "#f0b93c", "#9ad6f7")
"""`COLOURS` for a dark page, as the report has them."""

DASHES = {"solid": "none", "dash": "9 5", "dot": "2 4", "dashdot": "9 4 2 4"}

_HEIGHT, _PANEL, _LEFT, _RIGHT, _TOP, _BOTTOM = 380, 400, 66, 22, 62, 54
_CHARACTER = 7.2
"""Mean width of a character in the legend [px]."""


@dataclass(frozen=True)
class Line:
    """A curve.

    Attributes:
        label: In the legend; lines with the same label share an entry.
        x: Shape (n,).
        y: Shape (n,); NaN leaves a gap.
        colour: Index in the palette.
        dash: A key of `DASHES`.
    """

    label: str
    x: FloatArray
    y: FloatArray
    colour: int = 0
    dash: str = "solid"


@dataclass(frozen=True)
class Note:
    """Words in a panel.

    Attributes:
        words: What is said.
        x: Where they begin, as a value of the axis.
        y: On which height, likewise.
    """

    words: str
    x: float
    y: float


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    Attributes:
        lines: What is drawn.
        x_label: Under it, with the unit.
        y_label: Beside it, with the unit.
        title: Above it.
        x_range: First and last value; that of the data where not given.
        y_range: The same upwards.
        log_y: Whether the ordinate is logarithmic.
        shade: A range of x that is marked.
        notes: Words beside the curves.
    """

    lines: Sequence[Line]
    x_label: str
    y_label: str
    title: str = ""
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    log_y: bool = False
    shade: tuple[float, float] | None = None
    notes: Sequence[Note] = ()


def draw(panels: Sequence[Panel], description: str) -> str:
    """Draw panels side by side.

    Args:
        panels: From left to right; one legend for all.
        description: For those who cannot see it.

    Returns:
        An SVG document.
    """
    width = _PANEL * len(panels) if len(panels) > 1 else 2 * _PANEL - 160
    each = width / len(panels)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{_HEIGHT}" viewBox="0 0 {width} {_HEIGHT}" '
        'font-family="system-ui, Segoe UI, Roboto, Liberation Sans, sans-serif" font-size="13" role="img">',
        f"<title>{escape(description)}</title>",
        _style(),
        f'<rect class="paper" width="{width}" height="{_HEIGHT}" fill="#ffffff"/>',
        *_legend([line for panel in panels for line in panel.lines], width),
    ]
    for place, panel in enumerate(panels):
        parts += _panel(panel, place * each, each, place)
    return "\n".join([*parts, "</svg>", ""])


def _panel(panel: Panel, left: float, width: float, number: int) -> list[str]:
    x_low, x_high = panel.x_range or _extent([line.x for line in panel.lines])
    y_low, y_high = panel.y_range or _padded(_extent([line.y for line in panel.lines]))
    x = Axis(x_low, x_high, left + _LEFT, left + width - _RIGHT)
    y = Axis(y_low, y_high, _HEIGHT - _BOTTOM, _TOP, panel.log_y)
    box = f'x="{x.start:.1f}" y="{_TOP}" width="{x.end - x.start:.1f}" height="{_HEIGHT - _BOTTOM - _TOP}"'
    middle, centre = (x.start + x.end) / 2, (_TOP + _HEIGHT - _BOTTOM) / 2
    parts = [f'<clipPath id="panel{number}"><rect {box}/></clipPath>']
    if panel.shade is not None:
        a, b = x(panel.shade[0]), x(panel.shade[1])
        parts.append(
            f'<rect class="shade" x="{a:.1f}" y="{_TOP}" width="{b - a:.1f}" height="{_HEIGHT - _BOTTOM - _TOP}" '
            'fill="#eef2f7"/>'
        )
    for value, words in x.ticks():
        at = x(value)
        parts.append(_rule(at, _TOP, at, _HEIGHT - _BOTTOM))
        parts.append(_text(at, _HEIGHT - _BOTTOM + 18, words, "middle"))
    for value, words in y.ticks():
        at = y(value)
        parts.append(_rule(x.start, at, x.end, at))
        parts.append(_text(x.start - 7, at + 4.5, words, "end"))
    parts += [f'<g clip-path="url(#panel{number})">', *(_curve(line, x, y) for line in panel.lines), "</g>"]
    parts += [_text(x(note.x), y(note.y), note.words, "start") for note in panel.notes]
    parts.append(f'<rect class="frame" {box} fill="none" stroke="#5b6675"/>')
    parts.append(_text(middle, _HEIGHT - 12, panel.x_label, "middle"))
    turned = f' transform="rotate(-90 {left + 16:.1f} {centre:.1f})"'
    parts.append(_text(left + 16, centre, panel.y_label, "middle", turned))
    if panel.title:
        parts.append(_text(middle, _TOP - 9, panel.title, "middle", ' font-weight="600"'))
    return parts


def _curve(line: Line, x: Axis, y: Axis) -> str:
    path, pen = [], "M"
    for a, b in zip(line.x.tolist(), line.y.tolist(), strict=True):
        if math.isnan(b) or (y.log and b <= 0.0):
            pen = "M"
            continue
        path.append(f"{pen}{x(a):.1f} {y(b):.1f}")
        pen = "L"
    return f'<path d="{"".join(path)}" fill="none" {_stroke(line)}/>'


def _legend(lines: Sequence[Line], width: float) -> list[str]:
    entries = list({line.label: line for line in lines}.values())
    lengths = [44 + _CHARACTER * len(line.label) + 20 for line in entries]
    at, parts = max(8.0, (width - sum(lengths)) / 2), []
    for line, length in zip(entries, lengths, strict=True):
        parts.append(f'<path d="M{at:.1f} 20L{at + 36:.1f} 20" fill="none" {_stroke(line)}/>')
        parts.append(_text(at + 44, 24.5, line.label, "start"))
        at += length
    return parts


def _stroke(line: Line) -> str:
    dashes = DASHES[line.dash]
    dashed = "" if dashes == "none" else f' stroke-dasharray="{dashes}"'
    return f'class="s{line.colour}" stroke="{COLOURS[line.colour]}" stroke-width="2.2"{dashed}'


def _rule(x1: float, y1: float, x2: float, y2: float) -> str:
    return f'<path class="grid" d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}" stroke="#e1e5eb"/>'


def _text(x: float, y: float, words: str, anchor: str, more: str = "") -> str:
    place = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"'
    return f'<text class="ink" {place} fill="#1c2430"{more}>{escape(words)}</text>'


def _style() -> str:
    series = " ".join(f".s{i}{{stroke:{colour}}}" for i, colour in enumerate(DARK_COLOURS))
    return (
        "<style>@media (prefers-color-scheme: dark){.paper{fill:#14181e} .ink{fill:#e4e8ee} .grid{stroke:#2b323c} "
        f".frame{{stroke:#9aa5b3}} .shade{{fill:#1f2731}} {series}}}</style>"
    )


def _extent(arrays: Sequence[FloatArray]) -> tuple[float, float]:
    values = [value for array in arrays for value in array.tolist() if not math.isnan(value)]
    return min(values), max(values)


def _padded(extent: tuple[float, float]) -> tuple[float, float]:
    margin = 0.06 * (extent[1] - extent[0]) or 1.0
    return extent[0] - margin, extent[1] + margin
