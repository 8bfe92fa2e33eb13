"""NSGA-II (Deb et al. 2002), by pymoo."""

from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass
from pymoo.algorithms.moo.nsga2 import NSGA2 as PymooNSGA2  # noqa: N811

from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.strategies.ask_tell import drive
from divideropt.strategies.base import STRICT, Count, Evaluate


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

        def score(designs: FloatArray) -> tuple[FloatArray, FloatArray]:
            told = evaluate(designs)
            return told.F, told.G

        algorithm = PymooNSGA2(pop_size=self.population)
        shape = (len(problem.objectives), problem.constraint_count)
        drive(algorithm, problem.space, shape, score, self.generations, seed)
