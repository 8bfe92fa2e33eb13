"""The designs that benchmarks run over: the feasible ones among Sobol points of the box of divider.yaml."""

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from divideropt.campaign.load import default_campaign
from divideropt.campaign.plan import build_problem
from divideropt.models.base import FloatArray
from divideropt.models.divider import PARAMETERS, Divider

OBJECTIVES = ("steady_state_error", "dynamic_error", "source_pressure")

ROUNDING = 1e-10
"""Deviations below this are rounding: every method takes the rests from the same Newton iteration."""


@dataclass(frozen=True)
class Box:
    """Points of the box.

    Attributes:
        model: The valve of divider.yaml.
        designs: All points, shape (n, d), columns as in `PARAMETERS`.
        feasible: Which of them are feasible, shape (n,).
    """

    model: Divider
    designs: FloatArray
    feasible: NDArray[np.bool_]


def sobol_points(count: int) -> Box:
    """Return the first Sobol points of the box, whole, and which are feasible."""
    problem = build_problem(default_campaign())
    assert isinstance(problem.model, Divider)
    unit = qmc.Sobol(len(problem.space), rng=0).random_base2(math.ceil(math.log2(count)))[:count]
    points = qmc.scale(unit, problem.space.lower, problem.space.upper)
    told = problem.tell(problem.simulate(points))
    whole = [dict(problem.fixed) | dict(zip(problem.space.names, point, strict=True)) for point in points.tolist()]
    designs = np.array([[p[name] for name in PARAMETERS] for p in whole])
    return Box(problem.model, designs, told.feasible)


def objectives_of(model: Divider, quantities: FloatArray) -> FloatArray:
    """Take the objectives from rows of quantities, shape (n, 3)."""
    return quantities[:, [list(model.quantities).index(name) for name in OBJECTIVES]]


def exact_objectives(model: Divider, designs: FloatArray, known: Path | None, keep: Path | None) -> FloatArray:
    """Return the objectives by the reference solver, shape (n, 3).

    Args:
        model: The valve.
        designs: Shape (n, d).
        known: A file that an earlier run kept; where not given they are solved anew, in a quarter of a second each.
        keep: Where to keep them.
    """
    if known is None:
        print(f"solving {len(designs)} designs with Radau at rtol 1e-10", file=sys.stderr)
        quantities = model.reference().evaluate(designs)[0]
    else:
        with np.load(known) as file:
            given, solved, names = file["M"], file["ex"], file["names"].tolist()
        rows = {row.tobytes(): i for i, row in enumerate(given)}
        places = [rows.get(row.tobytes(), -1) for row in designs]
        if -1 in places or names != list(model.quantities):
            raise SystemExit(f"{known} has other designs or quantities than this run: leave --reference out")
        quantities = solved[places]
    if keep is not None:
        np.savez(keep, M=designs, ex=quantities, names=np.array(list(model.quantities)))
    return objectives_of(model, quantities)
