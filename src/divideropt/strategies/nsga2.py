"""NSGA-II (Deb et al. 2002): pymoo's, to the bit, with the population in arrays (`breeding.py`)."""

from typing import Annotated

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.problem import Problem
from divideropt.strategies.base import STRICT, Count, Evaluate


@dataclass(frozen=True, config=STRICT)
class NSGA2:
    """Options of NSGA-II; its operators are pymoo's defaults (SBX, polynomial mutation)."""

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
        from divideropt.strategies.breeding import Breeding, survivors  # noqa: PLC0415 (late: pymoo takes a third of a second)

        space, random = problem.space, np.random.default_rng(seed)
        breed = Breeding(space, random)
        first = breed.distinct(space.sample(self.population, random))
        told = evaluate(first)
        held = survivors(first, told.F, told.violation, len(first), random)
        for _ in range(self.generations - 1):
            children = breed.children(held, self.population)
            if len(children) == 0:  # nothing new can be bred
                return
            told = evaluate(children)
            held = survivors(
                np.concatenate([held.X, children]),
                np.concatenate([held.F, told.F]),
                np.concatenate([held.violation, told.violation]),
                self.population,
                random,
            )
