"""pygmo's NSGA-II and MOEA/D. Neither knows constraints, so both are told penalised objectives."""

from math import comb
from typing import Any

import numpy as np
import pygmo

from divideropt.models.base import FloatArray

from .interview import Interview

FOR_EVER = 10**6
"""Generations: the recorder ends the run."""

DIVISIONS = 13
"""Of MOEA/D's grid of weights in three objectives: 105 of them."""


def nsga2(interview: Interview, seed: int) -> None:
    """Population 100, in batches; the rest pygmo's defaults: SBX 0.95, η 10; mutation 0.01, η 50."""
    algorithm = pygmo.nsga2(gen=FOR_EVER, seed=seed)
    algorithm.set_bfe(pygmo.bfe(pygmo.member_bfe()))
    _evolve(algorithm, interview, 100, seed)


def moead(interview: Interview, seed: int) -> None:
    """Population 100, in three objectives 105, as a grid of weights asks; the rest pygmo's defaults."""
    k = interview.objectives
    size = 100 if k == 2 else comb(DIVISIONS + k - 1, k - 1)
    _evolve(pygmo.moead(gen=FOR_EVER, seed=seed), interview, size, seed)


def _evolve(algorithm: Any, interview: Interview, size: int, seed: int) -> None:
    problem = pygmo.problem(_Asking(interview))
    population = pygmo.population(problem, size, b=pygmo.bfe(pygmo.member_bfe()), seed=seed)
    pygmo.algorithm(algorithm).evolve(population)


class _Asking:
    """A problem in pygmo's words, which it copies: all copies ask the same recorder."""

    def __init__(self, interview: Interview) -> None:
        self._interview = interview

    def fitness(self, design: FloatArray) -> FloatArray:
        return np.asarray(self._interview.penalised(design[None])[0])

    def batch_fitness(self, designs: FloatArray) -> FloatArray:
        return self._interview.penalised(designs.reshape(-1, self._interview.variables)).ravel()

    def get_nobj(self) -> int:
        return self._interview.objectives

    def get_bounds(self) -> tuple[FloatArray, FloatArray]:
        return self._interview.lower, self._interview.upper

    def __deepcopy__(self, memo: object) -> "_Asking":
        return self
