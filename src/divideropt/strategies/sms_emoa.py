"""SMS-EMOA (Beume, Naujoks and Emmerich 2007): pymoo's, which keeps what adds most to the hypervolume."""

from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.strategies.base import STRICT, Count, Evaluate


@dataclass(frozen=True, config=STRICT)
class SMSEMOA:
    """Options of SMS-EMOA; its operators are pymoo's defaults (SBX, polynomial mutation).

    A generation of children competes with its parents at once, and the design that adds least to the hypervolume of
    the front that does not fit is left out, one after the other.
    """

    population: Annotated[int, Field(ge=4, le=100_000)] = 100
    """Designs in a generation."""
    generations: Count = 125
    """Generations, the initial population counted."""

    def budget(self, variables: int) -> int:
        """Most evaluations a run asks for; see `Strategy.budget`."""
        return self.population * self.generations

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """Suits any problem; see `Strategy.objection`."""
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Breed generation after generation; see `Strategy.run`."""
        from pymoo.algorithms.moo import sms  # noqa: PLC0415 (late: pymoo takes a third of a second)

        from divideropt.strategies.ask_tell import drive  # noqa: PLC0415

        def score(designs: FloatArray) -> tuple[FloatArray, FloatArray]:
            told = evaluate(designs)
            return told.F, told.G

        # pymoo's default survival is one object for all runs of a process
        algorithm = sms.SMSEMOA(pop_size=self.population, survival=sms.LeastHypervolumeContributionSurvival())
        shape = (len(problem.objectives), problem.constraint_count)
        drive(algorithm, problem.space, shape, score, self.generations, seed)
