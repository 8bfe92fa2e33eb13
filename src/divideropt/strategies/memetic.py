"""A memetic hybrid: NSGA-II for coverage, goal-attainment polishing of front members.

Polishing draws directions evenly over the simplex. For each it takes the front member nearest to the direction, fits
quadratics to the evaluated designs around it (`local_model.py`), and evaluates the design at which these attain the
direction's goals best, where that promises something new (`polishing.py`). Which of the two gets the next block is
decided by what either has gained of late an evaluation, never by the budget.
"""

from collections.abc import Callable
from typing import Annotated

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told
from divideropt.strategies.archive import Archive, reached
from divideropt.strategies.base import STRICT, BudgetSpentError, Count, Evaluate, within_budget
from divideropt.strategies.directions import DirectionSequence, reference_directions
from divideropt.strategies.polishing import Polisher

FIRST_GENERATIONS = 8
"""Generations of NSGA-II before the first polishing."""

BLOCK = 100
"""Designs that a block of polishing evaluates at most, in one batch."""

DIRECTIONS = 256
"""Directions drawn for a block, a power of two; those that promise nothing are passed over."""

GAUGE = 300
"""Fixed directions, at most, by which the gain of a block is measured."""

SPREE = 10
"""Blocks that the kind has which gains more, before both are tried again."""

FORGETTING = 0.4
"""Weight of the latest trial in what a kind of block is taken to gain: one trial is mostly chance."""


@dataclass(frozen=True, config=STRICT)
class Memetic:
    """Options of the hybrid."""

    population: Annotated[int, Field(ge=4, le=100_000)] = 100
    """Designs in a generation of NSGA-II."""
    evaluations: Count = 12_500
    """Budget of evaluations."""

    def budget(self, variables: int) -> int:
        """Most evaluations a run asks for; see `Strategy.budget`."""
        return self.evaluations

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """There must be something to trade, and a budget for the first generation; see `Strategy.objection`."""
        if objectives < 2:
            return (
                "population",
                "one objective has no front to cover; take complex, or give another objective",
            )
        if self.evaluations < self.population:
            return "evaluations", f"{self.evaluations} are fewer than the population of {self.population}; give more"
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Breed, then breed or polish, block by block; see `Strategy.run`."""
        search = _Search(problem, within_budget(evaluate, self.evaluations), self.population, seed)
        try:
            search.begin()
            search.alternate()
        except BudgetSpentError:
            return


class _Search:
    """The population, the archive and the models of one run."""

    def __init__(self, problem: Problem, evaluate: Evaluate, population: int, seed: int) -> None:
        from divideropt.strategies.breeding import Breeding, survivors  # noqa: PLC0415 (late: pymoo takes a third of a second)

        random = np.random.default_rng(seed)
        self._space, self._random, self._size = problem.space, random, population
        self._archive = Archive(problem, evaluate)
        self._polisher = Polisher(problem.space)
        self._breeding, self._survivors = Breeding(problem.space, random), survivors
        self._directions = DirectionSequence(len(problem.objectives), random)
        self._gauge = reference_directions(len(problem.objectives), max(GAUGE, len(problem.objectives)))
        self._pool: list[tuple[FloatArray, Told]] = []
        """What was evaluated since the last survival."""

    def begin(self) -> None:
        """Evaluate a random population, and breed some generations."""
        self._score(self._breeding.distinct(self._space.sample(self._size, self._random)))
        for _ in range(FIRST_GENERATIONS - 1):
            self._breed()

    def alternate(self) -> None:
        """Try both kinds of block, give those that follow to the one that gains more, and so on.

        Ends when neither finds a design that is new.
        """
        blocks = (self._polish, self._breed)
        rates = np.zeros(len(blocks))
        while True:
            tried = [self._gauged(block) for block in blocks]
            if not any(spent for spent, _ in tried):
                return
            latest = np.array([gain / spent if spent else 0.0 for spent, gain in tried])
            rates = FORGETTING * latest + (1.0 - FORGETTING) * rates
            for _ in range(SPREE):
                blocks[int(np.argmax(rates))]()

    def _gauged(self, block: Callable[[], int]) -> tuple[int, float]:
        """Run a block; return its evaluations and by what factor's logarithm λ fell, the mean over the gauge."""
        scale = self._archive.scale()
        before = reached(self._archive, scale, self._gauge)
        spent = block()
        return spent, float(np.mean(np.log(before / reached(self._archive, scale, self._gauge))))

    def _breed(self) -> int:
        """Evaluate a generation of NSGA-II, bred from the best of all since the last."""
        X = np.concatenate([designs for designs, _ in self._pool])
        F = np.concatenate([told.F for _, told in self._pool])
        violation = np.concatenate([told.violation for _, told in self._pool])
        held = self._survivors(X, F, violation, self._size, self._random)
        self._pool = [(held.X, Told(held.F, held.violation[:, None]))]
        children = self._breeding.children(held, self._size)
        if len(children):
            self._score(children)
        return len(children)

    def _polish(self) -> int:
        """Evaluate designs that promise to attain some directions' goals better."""
        if not self._archive.feasible:
            return 0
        scale = self._archive.scale()
        directions = self._directions.draw(DIRECTIONS)
        designs, visits = self._polisher.propose(self._archive, scale, directions, BLOCK)
        if len(designs):
            self._polisher.learn(designs, self._score(designs), scale, visits)
        return len(designs)

    def _score(self, designs: FloatArray) -> Told:
        told = self._archive.score(designs)
        self._archive.settle()
        self._polisher.hear(designs, told)
        self._pool.append((designs, told))
        return told
