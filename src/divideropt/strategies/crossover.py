"""The heuristic crossover of the author's genetic algorithm (C.4), in pymoo's words."""

from typing import Any

import numpy as np
from pymoo.core.crossover import Crossover
from pymoo.core.population import Population

from divideropt.models.base import FloatArray

CROSSOVER_RETRIES = 10
"""How often a child outside the bounds is drawn again, the second number of C.4's `heuristicXover` options."""


class HeuristicCrossover(Crossover):  # type: ignore[misc]
    """One child beyond the better parent, on the line from the worse; the other is the better parent."""

    def __init__(self) -> None:
        """Two parents, two children, every time."""
        super().__init__(n_parents=2, n_offsprings=2, prob=1.0)

    def do(self, problem: Any, pop: Any, *args: Any, **kwargs: Any) -> Population:
        """Cross pairs, the better parent first."""
        ranked = [sorted(pair, key=lambda parent: (parent.CV[0], parent.F[0])) for pair in pop]
        return super().do(problem, ranked, *args, **kwargs)

    def _do(
        self, problem: Any, X: FloatArray, *args: Any, random_state: np.random.Generator, **kwargs: Any
    ) -> FloatArray:
        better, worse = X
        child = better.copy()
        pending = np.ones(len(better), dtype=bool)
        for _ in range(CROSSOVER_RETRIES):
            trial = better + random_state.random((len(better), 1)) * (better - worse)
            inside = ((trial >= problem.xl) & (trial <= problem.xu)).all(axis=1)
            child[pending & inside] = trial[pending & inside]
            pending &= ~inside
        return np.stack([child, better])
