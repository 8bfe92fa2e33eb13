"""Driving a pymoo algorithm by ask and tell, so that every evaluation passes through our own call."""

import warnings
from collections.abc import Callable

from pymoo.config import Config
from pymoo.core.algorithm import Algorithm
from pymoo.core.evaluator import Evaluator
from pymoo.core.problem import Problem as PymooProblem
from pymoo.core.termination import NoTermination
from pymoo.problems.static import StaticProblem

from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace

Score = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Designs, shape (n, d), to objectives, shape (n, k), and constraints, shape (n, c): all finite."""

Config.warnings["not_compiled"] = False


def drive(
    algorithm: Algorithm,
    space: DesignSpace,
    shape: tuple[int, int],
    score: Score,
    generations: int,
    seed: int,
) -> None:
    """Run an algorithm for a number of generations.

    Args:
        algorithm: As configured; set up here.
        space: The design space.
        shape: Numbers of objectives and constraints.
        score: Answers a generation.
        generations: Budget, the initial population counted.
        seed: Seeds every draw.
    """
    problem = _Box(space, *shape)
    algorithm.setup(problem, seed=seed, termination=NoTermination())
    for _ in range(generations):
        infills = algorithm.ask()
        if infills is None or len(infills) == 0:  # nothing new can be bred
            return
        F, G = score(infills.get("X"))
        Evaluator().eval(StaticProblem(problem, F=F, G=G), infills)
        with warnings.catch_warnings():  # NSGA-III's normalisation would turn them all off for good
            algorithm.tell(infills=infills)


class _Box(PymooProblem):  # type: ignore[misc]
    """The design space in pymoo's words; it evaluates nothing itself."""

    def __init__(self, space: DesignSpace, objectives: int, constraints: int) -> None:
        super().__init__(n_var=len(space), n_obj=objectives, n_ieq_constr=constraints, xl=space.lower, xu=space.upper)
