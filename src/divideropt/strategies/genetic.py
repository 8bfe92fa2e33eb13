"""A genetic algorithm on one aggregate objective, as the thesis ran (section 3.5.2, C.4)."""

from typing import Annotated, Any

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass
from pymoo.algorithms.soo.nonconvex.ga import GA, comp_by_cv_and_fitness
from pymoo.core.crossover import Crossover
from pymoo.core.population import Population
from pymoo.operators.selection.tournament import TournamentSelection

from divideropt.models.base import FloatArray
from divideropt.problem import AGGREGATES, Problem
from divideropt.strategies.ask_tell import drive
from divideropt.strategies.base import STRICT, AggregateName, Count, Evaluate

CROSSOVER_RETRIES = 10
"""How often a child outside the bounds is drawn again, the second number of C.4's `heuristicXover` options."""


@dataclass(frozen=True, config=STRICT)
class Genetic:
    """Options of the genetic algorithm; the defaults are the author's.

    Binary tournament and heuristic crossover as in C.4; mutation is polynomial, since the toolbox's own depends on
    the number of generations to come, which a run here must not know.
    """

    aggregate: AggregateName = "goal_attainment"
    """How several objectives become one."""
    population: Annotated[int, Field(ge=4, le=100_000)] = 50
    """Designs in a generation."""
    generations: Count = 250
    """Generations, the initial population counted."""

    def budget(self, variables: int) -> int:
        """Most evaluations a run asks for; see `Strategy.budget`."""
        return self.population * self.generations

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """Suits any problem; see `Strategy.objection`."""
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Breed generation after generation; see `Strategy.run`."""
        aggregate = AGGREGATES[self.aggregate]

        def score(designs: FloatArray) -> tuple[FloatArray, FloatArray]:
            told = evaluate(designs)
            return aggregate(told.F, problem.objectives)[:, None], told.G

        algorithm = GA(
            pop_size=self.population,
            selection=TournamentSelection(pressure=2, func_comp=comp_by_cv_and_fitness),
            crossover=HeuristicCrossover(),
        )
        drive(algorithm, problem.space, (1, problem.constraint_count), score, self.generations, seed)


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
