"""The least program that optimises with pymoo in two processes: what its start costs, whatever it computes."""

import sys

import numpy as np
from joblib import Parallel, delayed
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.optimize import minimize


class Free(Problem):  # type: ignore[misc]
    """Two squares, of no cost."""

    def __init__(self) -> None:
        """Five variables, as divider.yaml has."""
        super().__init__(n_var=5, n_obj=2, xl=np.zeros(5), xu=np.ones(5))

    def _evaluate(self, x: np.ndarray, out: dict[str, np.ndarray], *args: object, **kwargs: object) -> None:
        out["F"] = np.column_stack([(x**2).sum(axis=1), ((x - 1) ** 2).sum(axis=1)])


def run(seed: int) -> int:
    """Two generations."""
    return len(minimize(Free(), NSGA2(pop_size=100), ("n_gen", 2), seed=seed).F)


if __name__ == "__main__":
    print(Parallel(n_jobs=int(sys.argv[1]))(delayed(run)(seed) for seed in (1, 2)))
