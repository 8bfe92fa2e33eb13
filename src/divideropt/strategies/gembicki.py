"""Gembicki's goal-attainment problem (1974), solved by SciPy on differences of the simulations.

Minimise γ + ρ Σ z_i/w_i over u and γ, subject to z_i(u) - w_i γ ≤ 0, the problem's constraints and the box, z being
the objectives scaled between a utopian and a middle point. The small ρ is Wierzbicki's augmentation: of two designs
with the same γ the one that is better in the other objectives wins, so that no answer is only weakly optimal.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import scipy

from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace, Told
from divideropt.strategies.archive import Scale

Solver = Literal["slsqp", "trust-constr"]
"""SciPy's methods that take constraints with derivatives."""

DIFFERENCE = 1e-3
"""Step of the differences, in parts of the box: a simulation's noise of 1e-6 becomes one of 1e-3 in a slope."""

PRECISION = 1e-5
"""Relative change of γ at which SLSQP stops, and the size of the trust region at which trust-constr does."""

ITERATIONS = 50
"""Most iterations of either."""


@dataclass(frozen=True)
class Goal:
    """What is attained.

    Attributes:
        direction: w, shape (k,), above 0.
        scale: Of the objectives.
        augmentation: ρ.
    """

    direction: FloatArray
    scale: Scale
    augmentation: float

    def of(self, F: FloatArray) -> FloatArray:
        """Return γ + ρ Σ z_i/w_i of objectives, shape (n, k) to (n,)."""
        parts = self.scale.of(F) / self.direction
        return np.asarray(parts.max(axis=1) + self.augmentation * parts.sum(axis=1))


def attain(
    start: FloatArray, goal: Goal, space: DesignSpace, score: Callable[[FloatArray], Told], by: Solver
) -> None:
    """Search for the design that attains a goal best; whoever answers `score` sees every design.

    Args:
        start: Shape (d,), in the variables' units.
        goal: What is attained.
        space: The box.
        score: Evaluates designs, shape (n, d); may end the search by raising.
        by: SciPy's method.
    """
    width = space.upper - space.lower
    u = np.clip((start - space.lower) / width, 0.0, 1.0)
    near = _Neighbourhood(lambda parts: score(space.clip(space.lower + parts * width)), goal)
    unit = max(float(near.at(u)[0].max()), np.finfo(float).tiny)
    d, k = len(u), len(goal.direction)
    slopes_of_gamma = np.append(np.zeros(d), 1.0)

    def value(v: FloatArray) -> float:
        return float(v[-1] + goal.augmentation * near.at(v[:-1])[0].sum() / unit)

    def gradient(v: FloatArray) -> FloatArray:
        summed = near.slopes_at(v[:-1])[0].sum(axis=0) / unit
        return np.asarray(slopes_of_gamma + goal.augmentation * np.append(summed, 0.0))

    def slack(v: FloatArray) -> FloatArray:
        parts, G = near.at(v[:-1])
        return np.concatenate([v[-1] - parts / unit, -G])

    def slack_slopes(v: FloatArray) -> FloatArray:
        of_parts, of_G = near.slopes_at(v[:-1])
        of_gamma = np.concatenate([np.ones(k), np.zeros(len(of_G))])
        return np.column_stack([np.concatenate([-of_parts / unit, -of_G]), of_gamma])

    bounds = scipy.optimize.Bounds(np.append(np.zeros(d), -np.inf), np.append(np.ones(d), np.inf), keep_feasible=True)
    minimize: Any = scipy.optimize.minimize  # whose stubs have no words for arrays of a length they do not know
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a step that led nowhere: the archive knows what came out
        if by == "slsqp":
            minimize(
                value,
                np.append(u, 1.0),
                jac=gradient,
                method="SLSQP",
                bounds=bounds,
                constraints={"type": "ineq", "fun": slack, "jac": slack_slopes},
                options={"maxiter": ITERATIONS, "ftol": PRECISION},
            )
        else:
            minimize(
                value,
                np.append(u, 1.0),
                jac=gradient,
                method="trust-constr",
                bounds=bounds,
                constraints=scipy.optimize.NonlinearConstraint(slack, 0.0, np.inf, jac=slack_slopes),
                options={"maxiter": ITERATIONS, "xtol": PRECISION, "initial_tr_radius": 0.1},
            )


class _Neighbourhood:
    """Values and slopes of z/w and of the constraints; each design is simulated once."""

    def __init__(self, score: Callable[[FloatArray], Told], goal: Goal) -> None:
        self._score, self._goal = score, goal
        self._values: dict[bytes, tuple[FloatArray, FloatArray]] = {}
        self._slopes: dict[bytes, tuple[FloatArray, FloatArray]] = {}

    def at(self, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return z/w, shape (k,), and the constraints, met where at most 0, shape (c,)."""
        key = u.tobytes()
        if key not in self._values:
            told = self._score(u.clip(0.0, 1.0)[None])
            self._values[key] = self._parts(told.F)[0], told.G[0]
        return self._values[key]

    def slopes_at(self, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return their slopes, shapes (k, d) and (c, d): differences inwards; 0 where a neighbour fails."""
        key = u.tobytes()
        if key not in self._slopes:
            parts, G = self.at(u)
            steps = np.where(u + DIFFERENCE <= 1.0, DIFFERENCE, -DIFFERENCE)
            told = self._score(u.clip(0.0, 1.0) + np.diag(steps))
            usable = (told.G[:, 0] <= 0.0) & (G[0] <= 0.0)
            per_step = np.where(usable, 1.0 / steps, 0.0)[:, None]
            self._slopes[key] = ((self._parts(told.F) - parts) * per_step).T, ((told.G - G) * per_step).T
        return self._slopes[key]

    def _parts(self, F: FloatArray) -> FloatArray:
        return np.asarray(self._goal.scale.of(F) / self._goal.direction)
