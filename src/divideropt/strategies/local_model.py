"""Quadratic models of objectives and constraints near a design, and the goal-attainment step on them.

A model is fitted to the nearest evaluated designs by least squares, weighted towards the centre. Objectives enter by
their logarithms above a utopian point: errors and pressures hang on a valve's dimensions nearly by powers, and the
best design of a direction is the same.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from divideropt.models.base import FloatArray

FULL_UP_TO = 10
"""Variables up to which a model has all mixed curvatures; beyond, those of each variable alone."""

POINTS_A_COEFFICIENT = 3
"""Designs to which a model is fitted, a coefficient."""

RIDGE = (0.0, 1e-4, 1e-2)
"""Penalty on constant, slopes and curvatures, in values a radius: what the designs do not tell stays small."""

SOFTENING = 0.1
"""A design's weight is 1/(this + d²), d its distance in radii: the centre counts ten times as much as the rim."""

STEP_ITERATIONS = 12
"""Iterations of SLSQP on a model, which is exact at its centre only."""

STEP_PRECISION = 1e-5
"""Gain in the logarithm of λ at which SLSQP stops."""


@dataclass(frozen=True)
class LocalModel:
    """Quadratics in s = (u - centre)/radius, u in parts of the box.

    Attributes:
        centre: Shape (d,), between 0 and 1.
        radius: Of the box in which designs were fitted, in parts of the whole.
        constants: Shape (m,): the objectives' logarithms, then the constraints.
        slopes: Shape (m, d).
        curvatures: Shape (m, d, d), symmetric.
    """

    centre: FloatArray
    radius: float
    constants: FloatArray
    slopes: FloatArray
    curvatures: FloatArray

    @classmethod
    def fitted(cls, centre: FloatArray, radius: float, designs: FloatArray, values: FloatArray) -> "LocalModel":
        """Fit to designs within a radius, shape (n, d), in parts of the box, and their values, shape (n, m)."""
        d = len(centre)
        rows, columns = _terms(d)
        scaled = (designs - centre) / radius
        weights = 1.0 / (SOFTENING + np.abs(scaled).max(axis=1) ** 2)
        basis = np.concatenate([np.ones((len(scaled), 1)), scaled, scaled[:, rows] * scaled[:, columns]], axis=1)
        basis *= weights[:, None]
        ridge = np.repeat(RIDGE, [1, d, len(rows)])
        normal = basis.T @ basis + np.diag(ridge**2)
        found = np.linalg.lstsq(normal, basis.T @ (values * weights[:, None]), rcond=None)[0]
        halves = np.zeros((values.shape[1], d, d))
        halves[:, rows, columns] = found[1 + d :].T
        return cls(centre, radius, found[0], found[1 : 1 + d].T, halves + halves.transpose(0, 2, 1))

    def step(self, weights: FloatArray, reach: float) -> tuple[FloatArray, float]:
        """Minimise the attainment max_i (f_i - log w_i) subject to the constraints g ≤ 0 (Gembicki's γ).

        Args:
            weights: The direction w, shape (k,), for the first k values.
            reach: How far from the centre, in parts of the box, in any variable.

        Returns:
            The design, shape (d,), in parts of the box, and the predicted fall of the attainment.
        """
        k = len(weights)
        within = reach / self.radius
        lower = np.maximum(-self.centre / self.radius, -within)
        upper = np.minimum((1.0 - self.centre) / self.radius, within)
        swing = np.abs(self.slopes).sum(axis=1) * within + 0.5 * np.abs(self.curvatures).sum(axis=(1, 2)) * within**2
        kept = np.arange(len(self.constants))
        kept = kept[(kept < k) | (self.constants + swing > 0.0)]
        constants = self.constants[kept] - np.concatenate([np.log(weights), np.zeros(len(kept) - k)])
        slopes, curvatures = self.slopes[kept], self.curvatures[kept]
        bounded = (kept < k).astype(float)
        begin = float(constants[:k].max())

        def slack(v: FloatArray) -> FloatArray:
            s = v[:-1]
            return np.asarray(bounded * v[-1] - constants - (slopes + 0.5 * (curvatures @ s)) @ s)

        def slack_slopes(v: FloatArray) -> FloatArray:
            return np.concatenate([-(slopes + curvatures @ v[:-1]), bounded[:, None]], axis=1)

        gradient = np.zeros(len(lower) + 1)
        gradient[-1] = 1.0
        minimize: Any = scipy.optimize.minimize  # whose stubs have no words for arrays of a length they do not know
        found = minimize(
            lambda v: v[-1],
            np.append(np.zeros(len(lower)), begin),
            jac=lambda _: gradient,
            method="SLSQP",
            bounds=scipy.optimize.Bounds(np.append(lower, -np.inf), np.append(upper, np.inf)),
            constraints={"type": "ineq", "fun": slack, "jac": slack_slopes},
            options={"maxiter": STEP_ITERATIONS, "ftol": STEP_PRECISION},
        )
        s = np.clip(np.nan_to_num(found.x[:-1]), lower, upper)
        return np.clip(self.centre + self.radius * s, 0.0, 1.0), begin - float(found.x[-1])


def points_wanted(variables: int) -> int:
    """To how many designs a model of so many variables is fitted."""
    return POINTS_A_COEFFICIENT * (1 + variables + len(_terms(variables)[0]))


@cache
def _terms(variables: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Which products of two variables a model has."""
    if variables <= FULL_UP_TO:
        return np.triu_indices(variables)
    return np.diag_indices(variables)  # type: ignore[return-value]
