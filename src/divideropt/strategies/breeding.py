"""NSGA-II's operators and its survival (Deb et al. 2002), on arrays: pymoo's, to the bit.

pymoo keeps an object an individual, and spends most of a generation on them. Here its operators, its sorting and its
crowding distance work on arrays, in the order in which its `NSGA2` calls them, with the same draws.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.duplicate import DefaultDuplicateElimination
from pymoo.core.problem import Problem as PymooProblem
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.survival.rank_and_crowding.metrics import get_crowding_function
from pymoo.util.misc import random_permutations
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting
from pymoo.util.randomized_argsort import randomized_argsort

from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace

NARROW = 1e-8
"""A variable of a smaller range counts in shares of it where designs are compared: pymoo takes two for one that are
closer than 1e-16, whatever the units."""

MOST_MATINGS = 100
"""How often parents are mated anew where children are duplicates."""


@dataclass(frozen=True)
class Population:
    """The designs held.

    Attributes:
        X: Shape (n, d).
        F: Objectives, shape (n, k).
        violation: Shape (n,).
        crowding: Crowding distance within the front, NaN where not feasible, shape (n,).
    """

    X: FloatArray
    F: FloatArray
    violation: FloatArray
    crowding: FloatArray


class Breeding:
    """Makes children that are not there yet."""

    def __init__(self, space: DesignSpace, random: np.random.Generator) -> None:
        """Breed in a design space, with these draws."""
        self._box, self._random = PymooProblem(n_var=len(space), xl=space.lower, xu=space.upper), random
        self._crossover, self._mutation = SBX(eta=15, prob=0.9), PM(eta=20)
        extent = space.upper - space.lower
        unit = np.where(extent < NARROW, extent, 1.0)
        self._duplicates = DefaultDuplicateElimination(func=lambda X: np.asarray(X) / unit)

    def distinct(self, X: FloatArray, *others: FloatArray) -> FloatArray:
        """Return the rows of X that stand neither above in X nor in the others."""
        return np.asarray(self._duplicates.do(X, *others))

    def children(self, held: Population, count: int) -> FloatArray:
        """Breed so many children, or fewer where that many cannot be found."""
        found = np.empty((0, held.X.shape[1]))
        for _ in range(MOST_MATINGS):
            fresh = self.distinct(self._mated(held, count - len(found)), held.X, found)
            found = np.concatenate([found, fresh[: count - len(found)]])
            if len(found) == count:
                break
        return found

    def _mated(self, held: Population, count: int) -> FloatArray:
        """Select parents, cross and mutate them: at least `count` children, an even number."""
        matings = math.ceil(count / 2)
        X = np.swapaxes(held.X[_tournaments(held, 2 * matings, self._random).reshape(matings, 2)], 0, 1)
        crossed = self._random.random(matings) < self._crossover.prob.value
        if crossed.any():
            X = np.where(crossed[:, None], self._crossover._do(self._box, X, random_state=self._random), X)
        X = X.reshape(2 * matings, -1)
        mutants = self._mutation._do(self._box, X, random_state=self._random)
        mutated = self._random.random(len(X)) <= self._mutation.prob.value
        return np.where(mutated[:, None], mutants, X)


def survivors(
    X: FloatArray, F: FloatArray, violation: FloatArray, count: int, random: np.random.Generator
) -> Population:
    """Keep the best: feasible front after front, the last by crowding distance; then the least violations.

    Args:
        X: Designs, shape (n, d).
        F: Their objectives, shape (n, k).
        violation: Their total violations, shape (n,).
        count: How many are kept.
        random: Breaks ties.
    """
    feasible, infeasible = np.flatnonzero(violation <= 0.0), np.flatnonzero(violation > 0.0)
    crowding = np.full(len(X), np.nan)
    kept: list[Any] = []
    room = min(count, len(feasible))
    fronts = _SORTING.do(F[feasible], n_stop_if_ranked=room) if len(feasible) else []
    for members in fronts:
        front = feasible[members]
        excess = max(0, len(front) - room)
        crowding[front] = _CROWDING.do(F[front], n_remove=excess)
        if excess:
            order = randomized_argsort(crowding[front], order="descending", method="numpy", random_state=random)
            front = front[order[:-excess]]
        kept.append(front)
        room -= len(front)
    wanted = count - sum(map(len, kept))
    kept.append(infeasible[np.argsort(violation[infeasible])][:wanted])
    rows = np.concatenate(kept)
    return Population(X[rows], F[rows], violation[rows], crowding[rows])


def _tournaments(held: Population, count: int, random: np.random.Generator) -> NDArray[np.intp]:
    """Play so many binary tournaments: less violation, else dominance, else more room, else chance; the winners."""
    permutations = random_permutations(math.ceil(2 * count / len(held.X)), len(held.X), random_state=random)
    pairs = permutations[: 2 * count].reshape(count, 2)
    first, second = pairs.T
    violated = held.violation[pairs]
    less = held.F[first] < held.F[second]
    more = held.F[second] < held.F[first]
    room = held.crowding[pairs]
    lead = np.where(
        (violated > 0.0).any(axis=1),
        np.sign(violated[:, 1] - violated[:, 0]),
        less.any(axis=1).astype(float) - more.any(axis=1),
    )
    lead = np.where((lead == 0.0) & (violated <= 0.0).all(axis=1), _sign_of_difference(room[:, 0], room[:, 1]), lead)
    winners = np.where(lead > 0.0, first, second)
    for i in np.flatnonzero(lead == 0.0):
        winners[i] = random.choice(pairs[i])
    return np.asarray(winners)


def _sign_of_difference(a: FloatArray, b: FloatArray) -> FloatArray:
    """Compare, where both may be infinite."""
    return (a > b).astype(float) - (a < b)


_SORTING, _CROWDING = NonDominatedSorting(), get_crowding_function("cd")
