"""A drawing as SVG for one design. The page's script, sketch.js, draws the same; a test holds the two together."""

import html
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib.resources import files

from divideropt.report.display import number, trimmed
from divideropt.report.sketch_layout import Drawing, Item

SHORT = 26.0
"""Below this length a dimension line has its arrows outside [px]."""

LETTER = 6.4
"""Width of a letter [px], to judge whether a label fits."""

DEFS = (
    '<defs><pattern id="sketch-hatch" width="7" height="7" patternUnits="userSpaceOnUse" '
    'patternTransform="rotate(45)"><rect class="ground" width="7" height="7"/><path class="hatch" d="M0 0V7"/>'
    '</pattern><pattern id="sketch-cut" width="5" height="5" patternUnits="userSpaceOnUse" '
    'patternTransform="rotate(-45)"><rect class="metal" width="5" height="5"/><path class="stroke" d="M0 0V5"/>'
    '</pattern><linearGradient id="sketch-round" x1="0" y1="0" x2="0" y2="1"><stop class="dark" offset="0"/>'
    '<stop class="light" offset="0.36"/><stop class="mid" offset="0.62"/><stop class="dark" offset="1"/>'
    "</linearGradient></defs>"
)
"""Hatches and the shade of what is round."""


def draw(drawing: Drawing, dimensions: Mapping[str, float]) -> str:
    """Draw a design.

    Args:
        drawing: The sketch, laid out for this design among others.
        dimensions: The design's, by name.

    Returns:
        The inner part of an SVG of the drawing's width and height.
    """
    values = [dimensions[name] for name in drawing.names]
    return DEFS + "".join(_item(item, drawing, values) for item in drawing.items)


def described(drawing: Drawing, dimensions: Mapping[str, float]) -> str:
    """Say the main dimensions, in place of the drawing."""
    values = [dimensions[name] for name in drawing.names]
    return ", ".join(
        f"{drawing.names[i].replace('_', ' ')} {_value(drawing, i, values)}".replace("_", " ") for i in drawing.main
    )


@cache
def light_style() -> str:
    """Return the sketch's styles in the light theme, without variables, for a file of its own."""
    folder = files("divideropt.report").joinpath("templates")
    sheets = [folder.joinpath(name).read_text("utf-8") for name in ("report.css", "sketch.css")]
    light = [sheet.split("@media")[0].partition("}")[0] for sheet in sheets]
    colours = dict(pair for block in light for pair in re.findall(r"(--[\w-]+): (#\w+)", block))
    rules = sheets[1].split("}\n", 1)[1].split("@media")[0]
    return re.sub(r"var\((--[\w-]+)\)", lambda found: colours[found[1]], rules)


def _item(item: Item, drawing: Drawing, values: Sequence[float]) -> str:
    if item["kind"] == "shape":
        return f'<path class="{item["style"]}" d="{_outline(item, values)}"/>'
    if item["kind"] == "measure":
        return _measure(item, drawing, values)
    if item["kind"] == "word":
        return _text(_at(item["x"], values), _at(item["y"], values) + 4.0, item["text"], "word")
    if item["kind"] == "note":
        return _text(item["x"], item["y"], ", ".join(_label(drawing, i, values) for i in item["columns"]), "note")
    if item["kind"] == "title":
        return _text(item["x"], item["y"], item["text"], "title")
    x, y, width = item["x"], item["y"], item["width"]
    bar = f'<path class="bar" d="M{x:.2f} {y - 4:.2f}v8M{x:.2f} {y:.2f}h{width:.2f}M{x + width:.2f} {y - 4:.2f}v8"/>'
    return bar + _text(x + width + 8.0, y + 4.0, item["text"], "scale", "start")


def _outline(item: Item, values: Sequence[float]) -> str:
    parts = []
    for letter, *numbers in item["steps"]:
        if letter == "A":
            radius, x, y = (_at(numbers[i], values) for i in (0, 2, 3))
            parts.append(f"A{radius:.2f} {radius:.2f} 0 0 {numbers[1]} {x:.2f} {y:.2f}")
        elif letter == "Z":
            parts.append("Z")
        else:
            parts.append(f"{letter}{_at(numbers[0], values):.2f} {_at(numbers[1], values):.2f}")
    return "".join(parts)


def _measure(item: Item, drawing: Drawing, values: Sequence[float]) -> str:
    level = item["side"] in ("above", "below")
    ends = [[_at(form, values) for form in item[key]] for key in ("begin", "end")]
    along, across = (0, 1) if level else (1, 0)
    (low, low_from), (high, high_from) = sorted((end[along], end[across]) for end in ends)
    at, text = item["at"], _label(drawing, item["column"], values)
    lines = [((low, low_from), (low, at)), ((high, high_from), (high, at))]
    short = high - low < SHORT
    lines += [((low - 14.0, at), (low, at)), ((high, at), (high + 14.0, at))] if short else [((low, at), (high, at))]
    turn = -1.0 if short else 1.0
    arrows = [_arrow(low, at, turn, level), _arrow(high, at, -turn, level)]
    path = "".join(_segment(begin, end, level) for begin, end in lines)
    drawn = f'<path class="measure" d="{path}"/><path class="arrow" d="{"".join(arrows)}"/>'
    if not level:
        x, anchor = (at - 8.0, "end") if item["side"] == "left" else (at + 8.0, "start")
        return drawn + _text(x, (low + high) / 2.0 + 4.0, text, "label", anchor)
    if LETTER * len(text) + 12.0 <= high - low:
        return drawn + _text((low + high) / 2.0, at - 5.0, text, "label")
    beside = 18.0 if short else 6.0
    if (low + high) / 2.0 < item["middle"] - 1.0:
        return drawn + _text(low - beside, at + 4.0, text, "label", "end")
    return drawn + _text(high + beside, at + 4.0, text, "label", "start")


def _segment(begin: tuple[float, float], end: tuple[float, float], level: bool) -> str:
    (a, b), (c, d) = (begin, end) if level else (begin[::-1], end[::-1])
    return f"M{a:.2f} {b:.2f}L{c:.2f} {d:.2f}"


def _arrow(tip: float, at: float, turn: float, level: bool) -> str:
    points = [(tip, at), (tip + turn * 8.0, at - 2.6), (tip + turn * 8.0, at + 2.6)]
    return "M" + "L".join(f"{a:.2f} {b:.2f}" if level else f"{b:.2f} {a:.2f}" for a, b in points) + "Z"


def _label(drawing: Drawing, column: int, values: Sequence[float]) -> str:
    return f"{drawing.labels[column][0]} = {_value(drawing, column, values)}"


def _value(drawing: Drawing, column: int, values: Sequence[float]) -> str:
    _, unit, scale = drawing.labels[column]
    text = trimmed(number(values[column] * scale))
    return f"{text} {unit}".rstrip() if unit != "°" else f"{text}°"


def _text(x: float, y: float, text: str, style: str, anchor: str = "middle") -> str:
    return f'<text class="{style}" x="{x:.2f}" y="{y:.2f}" text-anchor="{anchor}">{"".join(_spans(text))}</text>'


def _spans(text: str) -> Iterator[str]:
    """Lower what follows an underscore, raise what follows a circumflex."""
    shift = 0
    for part in re.findall(r"_[A-Za-z0-9]+|\^[0-9]|[^_^]+|.", text):
        want = {"_": 3, "^": -4}.get(part[0], 0) if len(part) > 1 else 0
        words = html.escape(part[1:] if want else part)
        small = ' class="small"' if want else ""
        yield f'<tspan{small} dy="{want - shift}">{words}</tspan>' if want != shift or small else words
        shift = want


def _at(form: Sequence[float], values: Sequence[float]) -> float:
    return form[0] + sum(form[i + 1] * values[int(form[i])] for i in range(1, len(form), 2))
