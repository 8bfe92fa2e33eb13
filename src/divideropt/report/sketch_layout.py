"""A model's sketch laid out on a sheet: coordinates in pixels, still linear combinations of a design's dimensions.

All designs of a page are laid out together, at one scale, so that they can be compared and a change of design moves
nothing but the design.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.dimensions import Dimension, Form, Measure, Shape, Sketch, Step, View, points_of
from divideropt.report.display import number, shown_as, trimmed

WIDTH = 1000.0
"""Of the drawing [px]; its height follows."""

TALLEST, TALLEST_DETAIL = 300.0, 190.0
"""Most height of the outlines in either row [px]."""

ROW, FIRST = 25.0, 20.0
"""Between dimension lines, and from the outline to the first [px]."""

BESIDE = 126.0
"""Kept free on a side with a label [px]."""

TITLE, FOOT, MARGIN = 34.0, 44.0, 14.0
"""Above a view, for its title; below, for notes and the scale bar; around each [px]."""

NARROWEST = 170.0
"""Width of a detail with its title [px]."""

TOUCH = 1e-6
"""Nearer than this to the middle a label stands on the right [m]."""

SCALES = (20.0, 15.0, 10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.5, 1.0, 0.5, 0.2, 0.1)
"""How much larger than the first view a detail may be."""

BARS = (1.0, 2.0, 5.0)
"""Lengths of a scale bar, times a power of ten."""

Item = dict[str, Any]
"""A part of the drawing, as the page's script reads it."""


@dataclass(frozen=True)
class Drawing:
    """A sketch on its sheet.

    Attributes:
        width: [px].
        height: [px].
        items: What is drawn, in this order. Coordinates are forms: a constant, then pairs of a column and a factor.
        names: The dimensions that are the columns.
        labels: Symbol, unit shown, and what to multiply a column by to have it in that unit, a column each.
        main: The columns that a text in place of the drawing names.
        caption: What it shows.
    """

    width: float
    height: float
    items: tuple[Item, ...]
    names: tuple[str, ...]
    labels: tuple[tuple[str, str, float], ...]
    main: tuple[int, ...]
    caption: str


def lay_out(sketch: Sketch, dimensions: Mapping[str, Dimension], columns: Mapping[str, FloatArray]) -> Drawing:
    """Lay a sketch out for some designs.

    Args:
        sketch: What the model draws.
        dimensions: Every dimension by name.
        columns: The designs' dimensions by name, at least one design.

    Returns:
        The drawing, for each of these designs.
    """
    first = [view for view in sketch.views if view.scale == 1.0]
    scale = _first_scale(first, columns)
    details = _fitted([view for view in sketch.views if view.scale != 1.0], scale, columns)
    names = tuple(dict.fromkeys(_named(sketch)))
    labels = []
    for name in names:
        shown = shown_as(dimensions[name].unit, columns[name])
        labels.append((dimensions[name].symbol or name.replace("_", " "), shown.unit, shown.scale))
    items: list[Item] = []
    y = 0.0
    for row in (first, details):
        views = [_Placed(view, scale * view.scale, columns) for view in row]
        gap = (WIDTH - sum(view.width for view in views)) / max(len(views), 1)
        x, height = gap / 2.0, max((view.height for view in views), default=0.0)
        for view in views:
            items += view.items(x, y, height, names)
            x += view.width + gap
        y += height
    main = tuple(names.index(name) for name in sketch.main)
    return Drawing(WIDTH, round(y), tuple(items), names, tuple(labels), main, sketch.caption)


class _Placed:
    """A view at a scale: how much room it takes, and where its items come to lie."""

    def __init__(self, view: View, scale: float, columns: Mapping[str, FloatArray]) -> None:
        """Measure it; `scale` in pixels a metre."""
        self.view, self.scale = view, scale
        self.left, self.top, self.right, self.bottom = (edge * scale for edge in _extent(view, columns))
        self.rows = {side: max((m.row for m in view.measures if m.side == side), default=0) for side in _SIDES}
        self.above = TITLE + (FIRST + ROW * self.rows["above"] if self.rows["above"] else MARGIN)
        self.below = FOOT + (FIRST + ROW * self.rows["below"] if self.rows["below"] else MARGIN)
        before, after = _labelled(view, columns)
        self.before = BESIDE if self.rows["left"] or before else MARGIN
        self.after = BESIDE if self.rows["right"] or after else MARGIN
        self.inner = self.right - self.left
        self.width = max(self.before + self.inner + self.after, NARROWEST if view.scale != 1.0 else 0.0)
        self.shift = (self.width - (self.before + self.inner + self.after)) / 2.0
        self.height = self.above + self.bottom - self.top + self.below

    def items(self, x: float, y: float, height: float, names: Sequence[str]) -> Iterator[Item]:
        """Place it in a row of the given height, whose views share their middle."""
        left = x + self.shift + self.before
        spare = height - self.height
        origin = (left - self.left, y + self.above + spare / 2.0 - self.top)

        def form(value: Form, axis: int) -> list[float]:
            terms = [(names.index(name), factor * self.scale) for name, factor in value.terms.items() if factor]
            return [round(origin[axis] + value.constant * self.scale, 3), *(part for term in terms for part in term)]

        middle = left + (self.right - self.left) / 2.0
        times = f" · {self.view.scale:g}×" if self.view.scale != 1.0 else ""
        yield {"kind": "title", "x": middle, "y": y + 16.0, "text": self.view.title + times}
        for shape in self.view.shapes:
            outlines = [steps for steps in (shape.steps, shape.hole) if steps]
            steps = [part for outline in outlines for part in _path(outline, form, self.scale, names)]
            yield {"kind": "shape", "style": shape.style, "traced": shape.traced, "steps": steps}
        for text, at in self.view.words:
            yield {"kind": "word", "x": form(at[0], 0), "y": form(at[1], 1), "text": text}
        edges = {
            "above": origin[1] + self.top, "below": origin[1] + self.bottom,
            "left": origin[0] + self.left, "right": origin[0] + self.right,
        }  # fmt: skip
        for m in self.view.measures:
            sign = 1.0 if m.side in ("below", "right") else -1.0
            points = [[form(point[axis], axis) for axis in (0, 1)] for point in (m.begin, m.end)]
            level = edges[m.side] + sign * (FIRST + ROW * (m.row - 1))
            yield {"kind": "measure", "side": m.side, "begin": points[0], "end": points[1], "at": round(level, 2),
                   "column": names.index(m.name), "middle": round(middle, 2)}  # fmt: skip
        foot = y + height - 12.0
        if self.view.notes:
            yield {
                "kind": "note",
                "x": middle,
                "y": foot - 18.0,
                "columns": [names.index(n) for n in self.view.notes],
            }
        length = _bar(self.scale)
        width = round(length * self.scale, 2)
        yield {
            "kind": "bar",
            "x": round(middle - width / 2.0, 2),
            "y": foot,
            "width": width,
            "text": _millimetres(length),
        }


_SIDES = ("above", "below", "left", "right")


def _labelled(view: View, columns: Mapping[str, FloatArray]) -> tuple[bool, bool]:
    """Whether labels of level dimension lines may stand on the left and on the right of a view's outlines."""
    left, _, right, _ = _extent(view, columns)
    middles = [
        float(np.mean(m.begin[0].of(columns) + m.end[0].of(columns))) - (left + right)
        for m in view.measures
        if m.side in ("above", "below")
    ]
    near = 0.5 * (right - left)  # a label beside a line in the middle of the first view has room within it
    if view.scale == 1.0:
        return any(middle < -near for middle in middles), any(middle > near for middle in middles)
    return any(middle < -TOUCH for middle in middles), any(middle >= -TOUCH for middle in middles)


def _path(steps: Sequence[Step], form: Any, scale: float, names: Sequence[str]) -> Iterator[list[Any]]:
    for i, step in enumerate(steps):
        point = [form(step.to[0], 0), form(step.to[1], 1)]
        if step.radius is None:
            yield ["L" if i else "M", *point]
        else:
            terms = [(names.index(name), factor * scale) for name, factor in step.radius.terms.items() if factor]
            radius = [step.radius.constant * scale, *(part for term in terms for part in term)]
            yield ["A", radius, int(step.clockwise), *point]
    if len(steps) > 2:  # a line that came back on itself would fill its own dashes
        yield ["Z"]


def _extent(view: View, columns: Mapping[str, FloatArray]) -> tuple[float, float, float, float]:
    """Left, top, right and bottom of a view over all designs [m]."""
    points = points_of(view.shapes)
    x = [point[0].of(columns) for point in points]
    y = [point[1].of(columns) for point in points]
    return float(np.min(x)), float(np.min(y)), float(np.max(x)), float(np.max(y))


def _first_scale(views: Sequence[View], columns: Mapping[str, FloatArray]) -> float:
    """Pixels a metre at which the first row fits."""
    extents = [_extent(view, columns) for view in views]
    outlines = sum(right - left for left, _, right, _ in extents)
    tallest = max(bottom - top for _, top, _, bottom in extents)
    margins = sum(_Placed(view, 0.0, columns).width for view in views)
    return float(min((WIDTH - margins) / outlines, TALLEST / tallest))


def _fitted(views: Sequence[View], scale: float, columns: Mapping[str, FloatArray]) -> list[View]:
    """Choose the details' scales, as large as asked for where there is room."""
    found = []
    for view in views:
        _, top, _, bottom = _extent(view, columns)
        fits = (s for s in SCALES if s <= view.scale and s * scale * (bottom - top) <= TALLEST_DETAIL)
        found.append(replace(view, scale=next(fits, SCALES[-1])))
    while sum(_Placed(view, scale * view.scale, columns).width for view in found) > WIDTH:
        widest = max(range(len(found)), key=lambda i: _Placed(found[i], scale * found[i].scale, columns).inner)
        smaller = [s for s in SCALES if s < found[widest].scale]
        if not smaller:
            break
        found[widest] = replace(found[widest], scale=smaller[0])
    return found


def _named(sketch: Sketch) -> Iterator[str]:
    """Name every dimension that the drawing needs."""
    for view in sketch.views:
        for form in _forms(view.shapes, view.measures):
            yield from form.terms
        for _, point in view.words:
            yield from (*point[0].terms, *point[1].terms)
        yield from (*(m.name for m in view.measures), *view.notes)
    yield from sketch.main


def _forms(shapes: Iterable[Shape], measures: Iterable[Measure]) -> Iterator[Form]:
    for shape in shapes:
        for step in (*shape.steps, *shape.hole):
            yield from step.to
            if step.radius is not None:
                yield step.radius
    for measure in measures:
        yield from (*measure.begin, *measure.end)


def _bar(scale: float) -> float:
    """A round length of some 60 to 150 pixels [m]."""
    lengths = (digit * 10.0**power for power in range(-7, 2) for digit in BARS)
    return next((length for length in lengths if length * scale >= 60.0), 100.0)


def _millimetres(length: float) -> str:
    return f"{trimmed(number(length * 1e3))} mm"
