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
_ROW = _HEIGHT - _TOP + 30
"""From one row of panels to the next [px]."""
_CHARACTER = 7.2
"""Mean width of a character in the legend [px]."""


@dataclass(frozen=True)
class Line:
    """A curve.

    Attributes:
        label: In the legend, unless empty; lines with the same label share an entry.
        x: Shape (n,).
        y: Shape (n,); NaN leaves a gap.
        colour: Index in the palette.
        dash: A key of `DASHES`.
        width: Of the stroke [px].
    """

    label: str
    x: FloatArray
    y: FloatArray
    colour: int = 0
    dash: str = "solid"
    width: float = 2.2


@dataclass(frozen=True)
class Area:
    """What lies between two curves.

    Attributes:
        label: In the legend; areas with the same label share an entry.
        x: Shape (n,).
        lower: One curve, shape (n,).
        upper: The other, shape (n,).
        colour: Index in the palette.
    """

    label: str
    x: FloatArray
    lower: FloatArray
    upper: FloatArray
    colour: int = 0


@dataclass(frozen=True)
class Dots:
    """Points by themselves.

    Attributes:
        label: In the legend.
        x: Shape (n,).
        y: Shape (n,).
        colour: Index in the palette.
        hollow: Whether they are rings.
        radius: Of a point [px].
    """

    label: str
    x: FloatArray
    y: FloatArray
    colour: int = 0
    hollow: bool = False
    radius: float = 4.0


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
        areas: What is filled, under the curves.
        dots: Points, over the curves.
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
    areas: Sequence[Area] = ()
    dots: Sequence[Dots] = ()


def draw(panels: Sequence[Panel], description: str, columns: int | None = None) -> str:
    """Draw panels side by side.

    Args:
        panels: From left to right, then downwards; one legend for all.
        description: For those who cannot see it.
        columns: Panels in a row; all where not given.

    Returns:
        An SVG document.
    """
    across = columns or len(panels)
    width = _PANEL * across if across > 1 else 2 * _PANEL - 160
    each = width / across
    height = _HEIGHT + _ROW * ((len(panels) - 1) // across)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" '
        'font-family="system-ui, Segoe UI, Roboto, Liberation Sans, sans-serif" font-size="13" role="img">',
        f"<title>{escape(description)}</title>",
        _style(filled=any(panel.areas or panel.dots for panel in panels)),
        f'<rect class="paper" width="{width}" height="{height}" fill="#ffffff"/>',
        *_legend([one for panel in panels for one in _drawn(panel)], width),
    ]
    for place, panel in enumerate(panels):
        row, column = divmod(place, across)
        drawn = _panel(panel, column * each, each, place)
        parts += [f'<g transform="translate(0 {row * _ROW})">', *drawn, "</g>"] if row else drawn
    return "\n".join([*parts, "</svg>", ""])


def _panel(panel: Panel, left: float, width: float, number: int) -> list[str]:
    curves = [one for one in _drawn(panel) if not isinstance(one, Area)]
    x_low, x_high = panel.x_range or _extent([curve.x for curve in curves])
    y_low, y_high = panel.y_range or _padded(_extent([curve.y for curve in curves]))
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
    parts.append(f'<g clip-path="url(#panel{number})">')
    parts += [_filled(area, x, y) for area in panel.areas]
    parts += [_curve(line, x, y) for line in panel.lines]
    parts += [_dot(dots, x(a), y(b)) for dots in panel.dots for a, b in zip(dots.x, dots.y, strict=True)]
    parts.append("</g>")
    parts += [_text(x(note.x), y(note.y), note.words, "start") for note in panel.notes]
    parts.append(f'<rect class="frame" {box} fill="none" stroke="#5b6675"/>')
    parts.append(_text(middle, _HEIGHT - 12, panel.x_label, "middle"))
    turned = f' transform="rotate(-90 {left + 16:.1f} {centre:.1f})"'
    parts.append(_text(left + 16, centre, panel.y_label, "middle", turned))
    if panel.title:
        parts.append(_text(middle, _TOP - 9, panel.title, "middle", ' font-weight="600"'))
    return parts


def _drawn(panel: Panel) -> list[Line | Area | Dots]:
    drawn: list[Line | Area | Dots] = [*panel.areas]
    drawn += panel.lines
    drawn += panel.dots
    return drawn


def _curve(line: Line, x: Axis, y: Axis) -> str:
    path, pen = [], "M"
    for a, b in zip(line.x.tolist(), line.y.tolist(), strict=True):
        if math.isnan(b) or (y.log and b <= 0.0):
            pen = "M"
            continue
        path.append(f"{pen}{x(a):.1f} {y(b):.1f}")
        pen = "L"
    return f'<path d="{"".join(path)}" fill="none" {_stroke(line)}/>'


def _filled(area: Area, x: Axis, y: Axis) -> str:
    there = zip(area.x.tolist(), area.upper.tolist(), strict=True)
    back = zip(area.x[::-1].tolist(), area.lower[::-1].tolist(), strict=True)
    outline = "L".join(f"{x(a):.1f} {y(b):.1f}" for a, b in (*there, *back))
    return f'<path d="M{outline}Z" {_fill(area.colour)} fill-opacity="0.35"/>'


def _dot(dots: Dots, x: float, y: float) -> str:
    ring = f'fill="none" stroke-width="1.6" class="s{dots.colour}" stroke="{COLOURS[dots.colour]}"'
    look = ring if dots.hollow else _fill(dots.colour)
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{dots.radius:g}" {look}/>'


def _legend(drawn: Sequence[Line | Area | Dots], width: float) -> list[str]:
    entries = list({one.label: one for one in drawn if one.label}.values())
    lengths = [44 + _CHARACTER * len(one.label) + 20 for one in entries]
    at, parts = max(8.0, (width - sum(lengths)) / 2), []
    for one, length in zip(entries, lengths, strict=True):
        match one:
            case Line():
                parts.append(f'<path d="M{at:.1f} 20L{at + 36:.1f} 20" fill="none" {_stroke(one)}/>')
            case Area():
                parts.append(f'<path d="M{at:.1f} 13h36v14h-36Z" {_fill(one.colour)} fill-opacity="0.35"/>')
            case Dots():
                parts.append(_dot(one, at + 18, 20.0))
        parts.append(_text(at + 44, 24.5, one.label, "start"))
        at += length
    return parts


def _stroke(line: Line) -> str:
    dashes = DASHES[line.dash]
    dashed = "" if dashes == "none" else f' stroke-dasharray="{dashes}"'
    return f'class="s{line.colour}" stroke="{COLOURS[line.colour]}" stroke-width="{line.width:g}"{dashed}'


def _fill(colour: int) -> str:
    return f'class="f{colour}" fill="{COLOURS[colour]}"'


def _rule(x1: float, y1: float, x2: float, y2: float) -> str:
    return f'<path class="grid" d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}" stroke="#e1e5eb"/>'


def _text(x: float, y: float, words: str, anchor: str, more: str = "") -> str:
    place = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"'
    return f'<text class="ink" {place} fill="#1c2430"{more}>{escape(words)}</text>'


def _style(*, filled: bool) -> str:
    series = " ".join(f".s{i}{{stroke:{colour}}}" for i, colour in enumerate(DARK_COLOURS))
    if filled:
        series += "".join(f" .f{i}{{fill:{colour}}}" for i, colour in enumerate(DARK_COLOURS))
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
