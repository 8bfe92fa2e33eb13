"""The designs of a report to scale: one drawing for all, and of each design the dimensions that vary."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from divideropt.campaign.plan import dimensioned
from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.report.display import rounded
from divideropt.report.front import Design
from divideropt.report.sketch_layout import Drawing, lay_out

SAME = 1e-9
"""Deviation within which a dimension is the same in all designs, or in proportion to another."""


@dataclass(frozen=True)
class Sketches:
    """A sketch of every design that a page can show.

    Attributes:
        drawing: Laid out for all of them.
        rows: Each design's row in the columns, by its id.
        columns: The dimensions that the drawing needs, by name, in their units.
    """

    drawing: Drawing
    rows: Mapping[str, int]
    columns: Mapping[str, FloatArray]


def read_sketches(problem: Problem, designs: Iterable[Design]) -> Sketches | None:
    """Measure designs for their sketches.

    Args:
        problem: What was optimised.
        designs: Every design that the page can show.

    Returns:
        The sketches; None without a design, or where the model offers none.
    """
    model = dimensioned(problem.model)
    known = {design.design_id: design.variables for design in designs}
    if model is None or not known:
        return None
    names = list(model.parameters)
    parameters = np.empty((len(known), len(names)))
    parameters[:] = [problem.fixed[name] for name in names]
    parameters[:, [names.index(name) for name in problem.space.names]] = list(known.values())
    columns = dict(zip(model.dimensions, model.measured(parameters).T, strict=True))
    drawing = lay_out(model.sketch, model.dimensions, columns)
    rows = {name: row for row, name in enumerate(known)}
    return Sketches(drawing, rows, {name: columns[name] for name in drawing.names})


def sketch_payload(found: Sketches, ids: Iterable[str]) -> dict[str, Any]:
    """Word the sketches for the page's script.

    Args:
        found: The sketches.
        ids: The page's designs, in its order.

    Returns:
        The drawing, its forms by what is stored, and a list a dimension that varies: a dimension that is constant is
        a number, one in proportion to another is the other's place and a factor.
    """
    order = np.array([found.rows[name] for name in ids], dtype=np.intp)
    drawing = found.drawing
    stored: list[Any] = []
    kept: dict[int, FloatArray] = {}
    for place, (name, (_, _, scale)) in enumerate(zip(drawing.names, drawing.labels, strict=True)):
        column = found.columns[name][order] * scale  # in the unit shown, which has the fewest digits
        size = float(np.abs(column).max(initial=0.0))
        if float(np.ptp(column)) <= SAME * size:
            stored.append(float(f"{column[0]:.9g}"))
            continue
        of = next((other for other in kept if _in_proportion(column, kept[other], size)), None)
        if of is not None:
            stored.append({"of": of, "times": float(column[0] / kept[of][0])})
        else:
            kept[place] = column
            stored.append([rounded(value) for value in column.tolist()])
    return {
        "width": drawing.width,
        "height": drawing.height,
        "items": [_scaled(item, [scale for _, _, scale in drawing.labels]) for item in drawing.items],
        "columns": stored,
        "names": [name.replace("_", " ") for name in drawing.names],
        "symbols": [symbol for symbol, _, _ in drawing.labels],
        "units": [unit for _, unit, _ in drawing.labels],
        "main": drawing.main,
    }


def _in_proportion(column: FloatArray, other: FloatArray, size: float) -> bool:
    if other[0] == 0.0:
        return False
    return bool(np.abs(column - other * (column[0] / other[0])).max() <= SAME * size)


def _scaled(item: Any, scales: list[float]) -> Any:
    """Divide the factors of forms by what their columns were multiplied by."""
    if isinstance(item, dict):
        return {key: value if key in ("columns", "column") else _scaled(value, scales) for key, value in item.items()}
    if not isinstance(item, list):
        return item
    if not item or not all(isinstance(part, int | float) for part in item):
        return [_scaled(part, scales) for part in item]
    found: list[float] = [round(float(item[0]), 3)]
    for i in range(1, len(item), 2):
        found += [int(item[i]), float(f"{item[i + 1] / scales[int(item[i])]:.7g}")]
    return found
