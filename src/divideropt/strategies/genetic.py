"""A genetic algorithm on one aggregate objective, as the thesis ran (section 3.5.2, C.4)."""

from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import AGGREGATES, Problem
from divideropt.strategies.base import STRICT, AggregateName, Count, Evaluate


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
        from pymoo.algorithms.soo.nonconvex.ga import GA, comp_by_cv_and_fitness  # noqa: PLC0415 (late: pymoo takes a third of a second)
        from pymoo.operators.selection.tournament import TournamentSelection  # noqa: PLC0415

        from divideropt.strategies.ask_tell import drive  # noqa: PLC0415
        from divideropt.strategies.crossover import HeuristicCrossover  # noqa: PLC0415

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
