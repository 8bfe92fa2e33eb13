"""What a model may offer beside its results: the dimensions of a design, and a drawing of them to scale.

A sketch's coordinates are linear combinations of dimensions, so that one drawing serves every design, and whoever
draws needs no more than a design's dimensions.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol, runtime_checkable

import numpy as np

from divideropt.models.base import FloatArray, Model


class Kind(StrEnum):
    """What sort of dimension it is; a sheet lists them in this order."""

    DIAMETER = "diameter"
    LENGTH = "length"
    ANGLE = "angle"
    AREA = "area"
    VOLUME = "volume"
    MASS = "mass"


@dataclass(frozen=True)
class Dimension:
    """A named dimension of a design.

    Attributes:
        name: Name in files, tables and the API.
        unit: The unit inside.
        symbol: Symbol in the equations, "" if it has none.
        description: What it is, in a line.
        kind: What sort it is.
        made_of: The parameters it hangs on, of a dimension that a workshop makes to a figure and that may be rounded.
        listed: Whether a sheet lists it; others only place what a sketch draws.
    """

    name: str
    unit: str
    symbol: str
    description: str
    kind: Kind
    made_of: tuple[str, ...] = ()
    listed: bool = True


@dataclass(frozen=True)
class Form:
    """A constant and multiples of dimensions, by name [m]."""

    constant: float = 0.0
    terms: Mapping[str, float] = field(default_factory=dict)

    def __add__(self, other: "Form | float") -> "Form":
        """Add term by term."""
        more = other if isinstance(other, Form) else Form(other)
        names = dict.fromkeys((*self.terms, *more.terms))
        terms = {name: self.terms.get(name, 0.0) + more.terms.get(name, 0.0) for name in names}
        return Form(self.constant + more.constant, terms)

    def __mul__(self, factor: float) -> "Form":
        """Multiply term by term."""
        return Form(self.constant * factor, {name: factor * value for name, value in self.terms.items()})

    def __neg__(self) -> "Form":
        """Turn every sign."""
        return self * -1.0

    def __sub__(self, other: "Form | float") -> "Form":
        """Subtract term by term."""
        return self + (-other)

    __rmul__ = __mul__

    def of(self, dimensions: Mapping[str, FloatArray]) -> FloatArray:
        """Evaluate it for designs whose dimensions are given, a column each."""
        total = np.full_like(next(iter(dimensions.values())), self.constant)
        for name, factor in self.terms.items():
            total += factor * dimensions[name]
        return total


def the(name: str) -> Form:
    """Begin a combination with a dimension."""
    return Form(0.0, {name: 1.0})


Point = tuple[Form, Form]
"""Right and down from the origin of the view."""


@dataclass(frozen=True)
class Step:
    """A step of an outline: to a point, straight or along an arc of a radius, no longer than a half circle.

    Attributes:
        to: Where to.
        radius: Of the arc; None for a straight line.
        clockwise: Which way the arc turns.
    """

    to: Point
    radius: Form | None = None
    clockwise: bool = True


@dataclass(frozen=True)
class Shape:
    """A closed outline.

    Attributes:
        steps: The first is where it begins.
        style: What it is: steel (from outside), cut, casing, oil, port, groove, edge or hidden.
        traced: Whether it is drawn, thinly, of other designs too.
        hole: A second outline, cut out of the first.
    """

    steps: tuple[Step, ...]
    style: str
    traced: bool = False
    hole: tuple[Step, ...] = ()


@dataclass(frozen=True)
class Measure:
    """A dimension line between two points of a view.

    Attributes:
        name: The dimension, equal to the distance of the points in the line's direction.
        begin: From where.
        end: To where; right of `begin`, or below it.
        side: Of the view on which the line stands: above, below, left or right.
        row: Which row or column of lines on that side, from 1.
    """

    name: str
    begin: Point
    end: Point
    side: str
    row: int = 1


@dataclass(frozen=True)
class View:
    """A part of a sketch with its own scale.

    Attributes:
        title: What it shows.
        shapes: Drawn in this order.
        measures: Dimension lines.
        words: Texts and where they are centred.
        notes: Dimensions that are written below it.
        scale: How much larger it is drawn than the first view, if there is room.
    """

    title: str
    shapes: tuple[Shape, ...]
    measures: tuple[Measure, ...] = ()
    words: tuple[tuple[str, Point], ...] = ()
    notes: tuple[str, ...] = ()
    scale: float = 1.0


@dataclass(frozen=True)
class Sketch:
    """A drawing to scale for any design.

    Attributes:
        views: The first row has those of scale 1, the second the details.
        main: The dimensions that a text in place of the drawing names.
        caption: What it shows, and what in it is not of the model's dimensions.
    """

    views: tuple[View, ...]
    main: tuple[str, ...]
    caption: str


@runtime_checkable
class Dimensioned(Model, Protocol):
    """A model that can say a design's dimensions, draw it, and turn changed dimensions back into parameters."""

    @property
    def dimensions(self) -> Mapping[str, Dimension]:
        """Every dimension, in the order of a row of `measured`."""
        ...

    @property
    def sketch(self) -> Sketch:
        """The drawing for any design."""
        ...

    def measured(self, designs: FloatArray) -> FloatArray:
        """Return the dimensions of designs.

        Args:
            designs: Shape (n, d), columns as in `parameters`.

        Returns:
            Shape (n, number of dimensions), in their units.
        """
        ...

    def remade(self, design: Mapping[str, float], dimensions: Mapping[str, float]) -> Mapping[str, float]:
        """Return the parameters of a design some of whose dimensions are others.

        Args:
            design: Every parameter by name.
            dimensions: New values of some dimensions that have `made_of`.

        Returns:
            Every parameter by name; what no changed dimension hangs on is as it was.
        """
        ...


def polygon(*points: Point) -> tuple[Step, ...]:
    """Return a closed outline of straight lines."""
    return tuple(Step(point) for point in points)


def rectangle(left: Form, top: Form, right: Form, bottom: Form) -> tuple[Step, ...]:
    """Return the outline of a rectangle."""
    return polygon((left, top), (right, top), (right, bottom), (left, bottom))


def circle(x: Form, y: Form, radius: Form) -> tuple[Step, ...]:
    """Return the outline of a circle, as four arcs."""
    around = ((x, y - radius), (x + radius, y), (x, y + radius), (x - radius, y))
    return (Step((x - radius, y)), *(Step(point, radius) for point in around))


def points_of(shapes: Iterable[Shape]) -> list[Point]:
    """List the points of outlines."""
    return [step.to for shape in shapes for step in (*shape.steps, *shape.hole)]
