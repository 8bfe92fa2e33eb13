"""The front of the welded beam, point by point: `python -m benchmarks.optimisers.welded_beam` writes its table.

For each deflection between the least possible and that of the cheapest beam, SciPy's SLSQP minimises the cost, from
the neighbour's solution and from random starts; the best that meets all constraints is kept. In a minute.
"""

from pathlib import Path
from typing import Any

import numpy as np
from pymoo.problems.multi import WeldedBeam
from scipy.optimize import minimize

from divideropt.models.base import FloatArray

TABLE = Path(__file__).with_name("welded_beam.csv")
"""Cost and deflection, a point of the front a row."""

POINTS = 300

STARTS = 6
"""Random ones a point, besides the neighbour's solution."""

TOLERANCE = 1e-7
"""Constraint violation allowed."""


def front() -> FloatArray:
    """Read the front, shape (POINTS, 2)."""
    return np.loadtxt(TABLE, delimiter=",", skiprows=1)


def _main() -> None:
    formula, random = WeldedBeam(), np.random.default_rng(1)
    cheapest = min((_cheapest(formula, 1.0, x) for x in _starts(formula, 40, random)), key=lambda found: found[1])
    stiffest = 2.1952 / (formula.xu[2] ** 3 * formula.xu[3])
    x, rows = cheapest[0], []
    for deflection in np.geomspace(cheapest[2], stiffest, POINTS):
        found = [_cheapest(formula, deflection, start) for start in (x, *_starts(formula, STARTS, random))]
        x, cost, reached = min(found, key=lambda one: one[1])
        rows.append((cost, reached))
    np.savetxt(TABLE, rows, delimiter=",", header="cost,deflection", comments="", fmt="%.9g")


def _starts(formula: Any, count: int, random: np.random.Generator) -> FloatArray:
    return np.asarray(formula.xl + (formula.xu - formula.xl) * random.random((count, 4)))


def _cheapest(formula: Any, deflection: float, start: FloatArray) -> tuple[FloatArray, float, float]:
    """Minimise the cost under a deflection; returns the design, its cost, infinite on failure, its deflection."""

    def told(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        F, G = formula.evaluate(x[None], return_values_of=["F", "G"])
        return F[0], np.append(G[0], F[0, 1] / deflection - 1.0)

    found = _MINIMISE(
        lambda x: told(x)[0][0],
        start,
        method="SLSQP",
        bounds=list(zip(formula.xl, formula.xu, strict=True)),
        constraints={"type": "ineq", "fun": lambda x: -told(x)[1]},
        options={"maxiter": 300, "ftol": 1e-12},
    )
    x = np.clip(found.x, formula.xl, formula.xu)
    F, G = told(x)
    return x, float(F[0]) if np.all(G <= TOLERANCE) else np.inf, float(F[1])


_MINIMISE: Any = minimize


if __name__ == "__main__":
    _main()
