"""NSGA-II (Deb et al. 2002): pymoo's, to the bit, with the population in arrays.

pymoo keeps an object an individual, and spends most of a generation on them. Here its operators, its sorting and its
crowding distance work on arrays, in the order in which its `NSGA2` calls them, with the same draws.
"""

import math
from dataclasses import dataclass as plain_dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from pydantic.dataclasses import dataclass
from pymoo.core.duplicate import DefaultDuplicateElimination
from pymoo.core.problem import Problem as PymooProblem
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.survival.rank_and_crowding.metrics import get_crowding_function
from pymoo.util.misc import random_permutations
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting
from pymoo.util.randomized_argsort import randomized_argsort

from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.strategies.base import STRICT, Count, Evaluate

MOST_MATINGS = 100
"""How often parents are mated anew where children are duplicates."""


@dataclass(frozen=True, config=STRICT)
class NSGA2:
    """Options of NSGA-II; its operators are pymoo's defaults (SBX, polynomial mutation)."""

    population: Annotated[int, Field(ge=4, le=100_000)] = 100
    """Designs in a generation."""
    generations: Count = 125
    """Generations, the initial population counted."""

    @property
    def budget(self) -> int:
        """Most evaluations a run asks for."""
        return self.population * self.generations

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """Suits any problem; see `Strategy.objection`."""
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Breed generation after generation; see `Strategy.run`."""
        space, random = problem.space, np.random.default_rng(seed)
        breed = _Breeding(PymooProblem(n_var=len(space), xl=space.lower, xu=space.upper), random)
        first = breed.distinct(space.sample(self.population, random))
        told = evaluate(first)
        held = _survivors(first, told.F, told.violation, len(first), random)
        for _ in range(self.generations - 1):
            children = breed.children(held, self.population)
            if len(children) == 0:  # nothing new can be bred
                return
            told = evaluate(children)
            held = _survivors(
                np.concatenate([held.X, children]),
                np.concatenate([held.F, told.F]),
                np.concatenate([held.violation, told.violation]),
                self.population,
                random,
            )


@plain_dataclass(frozen=True)
class _Population:
    """The designs held: their variables, objectives, total violation, crowding distance where feasible."""

    X: FloatArray
    F: FloatArray
    violation: FloatArray
    crowding: FloatArray


class _Breeding:
    """Makes children that are not there yet."""

    def __init__(self, box: PymooProblem, random: np.random.Generator) -> None:
        self._box, self._random = box, random
        self._crossover, self._mutation = SBX(eta=15, prob=0.9), PM(eta=20)
        self._duplicates = DefaultDuplicateElimination(func=np.asarray)

    def distinct(self, X: FloatArray, *others: FloatArray) -> FloatArray:
        """Return the rows of X that stand neither above in X nor in the others."""
        return np.asarray(self._duplicates.do(X, *others))

    def children(self, held: _Population, count: int) -> FloatArray:
        """Breed so many children, or fewer where that many cannot be found."""
        found = np.empty((0, held.X.shape[1]))
        for _ in range(MOST_MATINGS):
            fresh = self.distinct(self._mated(held, count - len(found)), held.X, found)
            found = np.concatenate([found, fresh[: count - len(found)]])
            if len(found) == count:
                break
        return found

    def _mated(self, held: _Population, count: int) -> FloatArray:
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


def _tournaments(held: _Population, count: int, random: np.random.Generator) -> NDArray[np.intp]:
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


def _survivors(
    X: FloatArray, F: FloatArray, violation: FloatArray, count: int, random: np.random.Generator
) -> _Population:
    """Keep the best: feasible front after front, the last by crowding distance; then the least violations."""
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
    return _Population(X[rows], F[rows], violation[rows], crowding[rows])


_SORTING, _CROWDING = NonDominatedSorting(), get_crowding_function("cd")
