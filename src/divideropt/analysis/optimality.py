"""How far a design is from Pareto-stationary: the Karush-Kuhn-Tucker residual, by non-negative least squares."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from divideropt.analysis.differences import STEP, Slopes, slopes_at
from divideropt.models.base import FloatArray, Quantity
from divideropt.problem import Constraint, Evaluations, Problem

KINK = 0.1
"""A slope that jumps by more than this share of its gradient is no slope; of an objective's gradient below 1, by more
than this itself. Unless it is the noise: """

NOISE = 10.0 * math.sqrt(20.0)
"""so many of its standard deviations make no kink, ten of those of a third difference. Ten is much, but they are
estimated from five values."""

MOST_STEPS = 100
"""Of the least squares, per unknown; some three are usual."""


@dataclass(frozen=True)
class Optimality:
    """How far a design is from Pareto-stationary.

    Attributes:
        residual: The rate at which one direction improves every objective at least: in parts of the objectives'
            scales, for a way of one range of the variables. 0 where there is no such direction.
        floor: What the noise of the differences may make of it; a residual below is zero within the noise.
    """

    residual: float
    floor: float

    @property
    def defined(self) -> bool:
        """Whether there are slopes to speak of."""
        return not math.isnan(self.residual)


NOT_DEFINED = Optimality(math.nan, math.nan)
"""At a kink, or where neighbours fail on both sides."""


def optimality(
    problem: Problem,
    scales: FloatArray,
    design: FloatArray,
    quantities: FloatArray,
    around: Evaluations,
    step: float = STEP,
) -> Optimality:
    """Measure a feasible design: min ‖Σ λ_i ∇F_i + Σ μ_j ∇G_j + Σ ν_b n_b‖ with λ, μ, ν ≥ 0 and Σ λ_i = 1.

    Variables count in parts of their ranges, objectives in their scales. Constraints, and bounds of the box, are
    active that are reached within a step of the differences; a side on which a neighbour fails counts as a bound. A
    signed objective that is 0 within a step is kept there by a multiplier of either sign, outside of Σ λ_i = 1: its
    magnitude has no gradient at 0, and no better value either.

    Args:
        problem: What is optimised.
        scales: Of the objectives, shape (k,).
        design: Shape (d,), in the variables' units.
        quantities: What came out, shape (m,).
        around: Its `neighbours`, as simulated.
        step: With which they were made.

    Returns:
        The residual; `NOT_DEFINED` at a kink of an objective or of an active constraint.
    """
    wanted = [*(o.quantity for o in problem.objectives), *(c.quantity for c in problem.constraints)]
    places = {name: i for i, name in enumerate(problem.model.quantities)}
    columns = [places[q.name] for q in wanted]
    values, beside = quantities[columns], around.quantities[:, columns]
    usable = np.array([v.ok for v in around.verdicts], dtype=bool) & np.isfinite(beside).all(axis=1)
    slopes = slopes_at(design, problem.space, values, beside, usable, step)
    if slopes is None:
        return NOT_DEFINED
    count = len(problem.objectives)
    terms = [
        *(_objective(q, i, values[i], scales[i], slopes, step) for i, q in enumerate(wanted[:count])),
        *(
            t
            for j, c in enumerate(problem.constraints, count)
            for t in _constraint(c, j, float(values[j]), slopes, step)
        ),
    ]
    if any(term is None for term in terms):
        return NOT_DEFINED
    walls = [_Term(normal, np.zeros_like(normal)) for normal in _walls(problem, design, slopes, step)]
    return _least([term for term in terms if term is not None] + walls)


@dataclass(frozen=True)
class _Term:
    """A column of the least squares: a gradient, its error, and what its multiplier may be."""

    gradient: FloatArray
    error: FloatArray
    share: bool = False  # whether the multiplier counts for Σ λ = 1
    free: bool = False  # whether it may be negative


def _least(terms: list[_Term]) -> Optimality:
    """Solve for the multipliers.

    Of the multiples s of one set of multipliers with Σ λ = 1 and residual r, the least of (s r)² + w² (s - 1)² is
    w² r²/(w² + r²), which grows with r: so NNLS with one more row, w Σ λ = w, finds the least r, whatever w.
    """
    shares = [term for term in terms if term.share]
    if not shares:
        return Optimality(0.0, 0.0)
    columns = [(term, side) for term in terms for side in ((1.0, -1.0) if term.free else (1.0,))]
    gradients = np.column_stack([side * term.gradient for term, side in columns])
    weight = max(float(np.linalg.norm(term.gradient)) for term in shares) or 1.0
    row = np.array([weight * term.share for term, _ in columns])
    goal = np.append(np.zeros(len(gradients)), weight)
    multipliers, _ = nnls(np.vstack([gradients, row]), goal, maxiter=MOST_STEPS * len(row))
    multipliers = multipliers / (row @ multipliers / weight)
    errors = np.column_stack([term.error for term, _ in columns])
    return Optimality(float(np.linalg.norm(gradients @ multipliers)), float(np.linalg.norm(errors @ multipliers)))


def _objective(
    quantity: Quantity, place: int, value: float, scale: float, slopes: Slopes, step: float
) -> _Term | None:
    gradient, error = slopes.gradients[place] / scale, slopes.errors[place] / scale
    norm = float(np.linalg.norm(gradient))
    if slopes.jumps[place].max() > max(KINK * max(norm, 1.0) * scale, NOISE * slopes.noise[place] / step):
        return None
    if not quantity.signed:
        return _Term(gradient, error, share=True)
    if abs(value) / scale <= step * norm:
        return _Term(gradient, error, free=True)
    return _Term(math.copysign(1.0, value) * gradient, error, share=True)


def _constraint(
    constraint: Constraint, place: int, value: float, slopes: Slopes, step: float
) -> Iterator[_Term | None]:
    """The active bounds of a constraint, as gradients of length 1: its multiplier may be any. None at a kink."""
    gradient = slopes.gradients[place]
    norm = float(np.linalg.norm(gradient))
    signed = constraint.quantity.signed
    jump = float(slopes.jumps[place].max())
    kinked = jump > max(KINK * norm, NOISE * slopes.noise[place] / step)
    steepest = max(norm, jump) if kinked else norm
    reach = step * steepest
    size, sign = (abs(value), math.copysign(1.0, value)) if signed else (value, 1.0)
    for side, bound in ((-1.0, constraint.minimum), (1.0, constraint.maximum)):
        if steepest == 0.0 or bound is None or side * (bound - size) > reach:
            continue
        undefined = kinked or (signed and size <= reach)
        yield None if undefined else _Term(side * sign * gradient / norm, slopes.errors[place] / norm)


def _walls(problem: Problem, design: FloatArray, slopes: Slopes, step: float) -> Iterator[FloatArray]:
    """Outward normals of the sides to which there is no way: bounds within a step, and failing neighbours."""
    space = problem.space
    near = step * (space.upper - space.lower)
    sides = ((-1.0, design - space.lower <= near), (1.0, space.upper - design <= near))
    for (direction, on), failing in zip(sides, slopes.failing, strict=True):
        for i in np.flatnonzero(on | failing):
            yield direction * np.eye(len(space))[i]
