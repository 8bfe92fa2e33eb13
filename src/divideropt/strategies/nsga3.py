"""NSGA-III (Deb and Jain 2014): pymoo's, with a tournament and a scale that its runs can be repeated with.

Two things are not as pymoo has them. Its tournament compares infeasible designs by a call that draws ties from a
generator without a seed; ours draws them from the run's. And its normalisation calls what is below 1e-3 or 1e-6 zero,
whatever the unit; so objectives reach it in scales of their quantities, where 1 is a typical size.
"""

from math import comb
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.strategies.base import STRICT, Count, Evaluate

if TYPE_CHECKING:
    from pymoo.core.population import Population


@dataclass(frozen=True, config=STRICT)
class NSGA3:
    """Options of NSGA-III; its operators are pymoo's defaults (SBX, polynomial mutation)."""

    population: Annotated[int, Field(ge=4, le=100_000)] = 100
    """Designs in a generation."""
    generations: Count = 125
    """Generations, the initial population counted."""
    directions: Annotated[int, Field(ge=3, le=10_000)] = 91
    """Reference directions, spread evenly (Das and Dennis); the largest such set of at most this many."""

    def budget(self, variables: int) -> int:
        """Most evaluations a run asks for; see `Strategy.budget`."""
        return self.population * self.generations

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """Each objective needs a direction, each direction a design; see `Strategy.objection`."""
        if self.directions < objectives:
            return "directions", f"{self.directions} are fewer than the {objectives} objectives; give more"
        made = comb(_parts(objectives, self.directions) + objectives - 1, objectives - 1)
        if self.population < made:
            return "population", (
                f"{self.population} are fewer than the {made} directions, each of which is to keep a design; "
                f"give at least {made}, or fewer directions"
            )
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Breed generation after generation; see `Strategy.run`."""
        from pymoo.algorithms.moo import nsga3  # noqa: PLC0415 (late: pymoo takes a third of a second)
        from pymoo.operators.selection.tournament import TournamentSelection  # noqa: PLC0415
        from pymoo.util.reference_direction import UniformReferenceDirectionFactory  # noqa: PLC0415

        from divideropt.strategies.ask_tell import drive  # noqa: PLC0415

        scales = np.array([o.quantity.scale for o in problem.objectives])
        parts = _parts(len(scales), self.directions)
        directions = UniformReferenceDirectionFactory(len(scales), n_partitions=parts).do()

        def score(designs: FloatArray) -> tuple[FloatArray, FloatArray]:
            told = evaluate(designs)
            return told.F / scales, told.G

        algorithm = nsga3.NSGA3(
            directions,
            pop_size=self.population,
            selection=TournamentSelection(func_comp=by_violation_then_chance),
        )
        drive(algorithm, problem.space, (len(scales), problem.constraint_count), score, self.generations, seed)


def by_violation_then_chance(
    held: "Population", pairs: NDArray[np.intp], random_state: np.random.Generator, **_: Any
) -> NDArray[np.intp]:
    """Play tournaments: less violation wins, else chance.

    Args:
        held: The population.
        pairs: Who plays whom, shape (n, 2).
        random_state: Draws a coin for each pair, tied or not.

    Returns:
        The winners, shape (n, 1).
    """
    violation = held.get("CV")[:, 0][pairs]
    first = random_state.random(len(pairs)) < 0.5
    lead = violation[:, 1] - violation[:, 0]
    first = np.where(lead == 0.0, first, lead > 0.0)
    return np.where(first, pairs[:, 0], pairs[:, 1])[:, None]


def _parts(objectives: int, most: int) -> int:
    """Into how many parts an edge of the simplex is divided: the most that make no more than so many directions."""
    parts = 1
    while objectives > 1 and comb(parts + objectives, objectives - 1) <= most:
        parts += 1
    return parts
