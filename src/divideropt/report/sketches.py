"""The designs of a report to scale: one drawing for all, and of each design the dimensions that vary."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from divideropt.campaign.plan import dimensioned
from divideropt.models.base import FloatArray
from divideropt.models.dimensions import Dimensioned
from divideropt.problem import Problem
from divideropt.report.display import rounded
from divideropt.report.sketch_layout import lay_out

SAME = 1e-9
"""Deviation within which a dimension is the same in all designs, or in proportion to another."""


@dataclass(frozen=True)
class Sketches:
    """What draws any design of a campaign.

    Attributes:
        model: Whose sketch.
        fixed: Every parameter by name, as each design has it but for the variables.
        names: The variables.
    """

    model: Dimensioned
    fixed: Mapping[str, float]
    names: tuple[str, ...]

    def measured(self, variables: FloatArray) -> dict[str, FloatArray]:
        """Return the dimensions of designs by name, a column each; `variables` has a row a design."""
        parameters = list(self.model.parameters)
        rows = np.empty((len(variables), len(parameters)))
        rows[:] = [self.fixed[name] for name in parameters]
        rows[:, [parameters.index(name) for name in self.names]] = variables
        return dict(zip(self.model.dimensions, self.model.measured(rows).T, strict=True))


def read_sketches(problem: Problem) -> Sketches | None:
    """Return what draws a campaign's designs; None where the model offers no sketch."""
    model = dimensioned(problem.model)
    return None if model is None else Sketches(model, problem.fixed, problem.space.names)


def sketch_payload(
    found: Sketches, variables: FloatArray, more: Sequence[Mapping[str, float]] = ()
) -> dict[str, Any] | None:
    """Word the sketches for the page's script.

    Args:
        found: What draws them.
        variables: Those of the page's designs, in its order, shape (n, d) with n at least 1.
        more: The dimensions of what else is drawn, by name.

    Returns:
        The drawing, laid out for all of them, and a list a dimension that varies, the designs first: a dimension
        that is constant is a number, one in proportion to another is the other's place and a factor, and null is what
        is not known. None where no design has all its variables.
    """
    known = np.flatnonzero(np.isfinite(variables).all(axis=1))
    if len(known) == 0:
        return None
    columns = {
        name: np.concatenate([column, [other[name] for other in more]])
        for name, column in found.measured(variables[known]).items()
    }
    rows = [*known.tolist(), *range(len(variables), len(variables) + len(more))]
    drawing = lay_out(found.model.sketch, found.model.dimensions, columns)
    stored: list[Any] = []
    kept: dict[int, FloatArray] = {}
    for place, (name, (_, _, scale)) in enumerate(zip(drawing.names, drawing.labels, strict=True)):
        column = columns[name] * scale  # in the unit shown, which has the fewest digits
        size = float(np.abs(column).max(initial=0.0))
        if float(np.ptp(column)) <= SAME * size:
            stored.append(float(f"{column[0]:.9g}"))
            continue
        of = next((other for other in kept if _in_proportion(column, kept[other], size)), None)
        if of is not None:
            stored.append({"of": of, "times": float(column[0] / kept[of][0])})
        else:
            kept[place] = column
            values: list[float | None] = [None] * (len(variables) + len(more))
            for row, value in zip(rows, column.tolist(), strict=True):
                values[row] = rounded(value)
            stored.append(values)
    return {
        "width": drawing.width,
        "height": drawing.height,
        "items": [_scaled(item, [scale for _, _, scale in drawing.labels]) for item in drawing.items],
        "columns": stored,
        "names": [name.replace("_", " ") for name in drawing.names],
        "symbols": [symbol for symbol, _, _ in drawing.labels],
        "units": [unit for _, unit, _ in drawing.labels],
        "main": drawing.main,
        "caption": drawing.caption,
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
