"""pymoo's NSGA-II as its users call it."""

from typing import Any

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.config import Config
from pymoo.core.problem import Problem
from pymoo.optimize import minimize

from .interview import Interview

Config.warnings["not_compiled"] = False


def nsga2(interview: Interview, seed: int) -> None:
    """Population 100; SBX 0.9, η 15; polynomial mutation, η 20."""
    minimize(_Asking(interview), NSGA2(pop_size=100), ("n_gen", 10**9), seed=seed)


class _Asking(Problem):  # type: ignore[misc]
    def __init__(self, interview: Interview) -> None:
        self._interview = interview
        super().__init__(
            n_var=interview.variables, n_obj=interview.objectives, n_ieq_constr=interview.constraints,
            xl=interview.lower, xu=interview.upper,
        )  # fmt: skip

    def _evaluate(self, x: np.ndarray[Any, Any], out: dict[str, Any], *args: object, **kwargs: object) -> None:
        told = self._interview(x)
        out["F"], out["G"] = told.F, told.G

    def __deepcopy__(self, memo: object) -> "_Asking":
        return self
