"""What each run did: its budget, how its simulations ended, how its hypervolume and its goal attainment grew."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from divideropt.analysis import Summary, attainment_history, hypervolume_history, repeatable
from divideropt.campaign.ending import Ended
from divideropt.campaign.plan import Run
from divideropt.models import Outcome
from divideropt.models.base import FloatArray
from divideropt.problem import Objective, Told

MARKS = 60
"""Points of a run's history: half of them early, where most is gained."""

COSTLY_MARKS = 12
"""The same from five objectives on, where one hypervolume may take seconds."""


@dataclass(frozen=True)
class RunFacts:
    """One run.

    Attributes:
        name: Its name.
        strategy: Its strategy.
        seed: Its seed.
        evaluations: Evaluations logged.
        budget: Most evaluations it asks for.
        feasible: Designs whose outcome is ok and which keep every constraint.
        outcomes: How many simulations ended how; only those that occurred.
        own: The same without those that a branch has of the run from which it branched.
        examples: A sentence of the first simulation that ended so.
        marks: Numbers of evaluations at which the histories are taken.
        hypervolumes: Hypervolume up to each mark; empty without a reference point.
        attainments: Least max λ_i of (3.24) up to each mark, infinite before the first feasible design; empty where
            an objective has no goal.
        least: Least value of the first objective up to each mark, infinite before the first feasible design.
        ending: Why it ended, in a sentence; "" before it has.
        best: Row of the log of the design with the least max λ_i, and that value; None where there is none.
    """

    name: str
    strategy: str
    seed: int
    evaluations: int
    budget: int
    feasible: int
    outcomes: Mapping[str, int]
    own: Mapping[str, int]
    examples: Mapping[str, str]
    marks: tuple[int, ...]
    hypervolumes: tuple[float, ...]
    attainments: tuple[float, ...]
    least: tuple[float, ...]
    best: tuple[int, float] | None
    ending: str

    @property
    def repeatable(self) -> bool:
        """Whether the run comes out the same from scratch."""
        return repeatable(self.outcomes)

    @property
    def hypervolume(self) -> float | None:
        """Hypervolume at the end, None without a reference point."""
        return self.hypervolumes[-1] if self.hypervolumes else None


def read_run(
    run: Run,
    log: Summary,
    objectives: Sequence[Objective],
    reference: FloatArray | None,
    ended: Ended | None,
    shortest: int,
) -> RunFacts:
    """Say what a run did.

    Args:
        run: As planned.
        log: Its evaluations so far.
        objectives: With goals or not.
        reference: The reference point, shape (k,), or None.
        ended: How it ended, None before it has.
        shortest: Evaluations of the shortest run of its strategy, at whose marks all of them are compared.
    """
    told = log.told
    common = marks_of(min(shortest, log.evaluations), len(objectives))
    marks = tuple(sorted({*marks_of(log.evaluations, len(objectives)), *common}))
    volumes = () if reference is None else tuple(hypervolume_history(told, reference, marks))
    return RunFacts(
        run.name,
        run.strategy,
        run.seed,
        log.evaluations,
        run.budget,
        int(told.feasible.sum()),
        dict(sorted(log.outcomes.items(), key=lambda item: list(Outcome).index(Outcome(item[0])))),
        log.own,
        log.examples,
        marks,
        volumes,
        () if any(o.goal is None for o in objectives) else tuple(attainment_history(told, objectives, marks)),
        _least(told, marks),
        None if log.best is None else (log.best.row, log.best.value),
        "" if ended is None else ended.text,
    )


def marks_of(evaluations: int, objectives: int) -> tuple[int, ...]:
    """Numbers of evaluations at which a run of so many is looked at; none of none."""
    if evaluations == 0:
        return ()
    count = (MARKS if objectives < 5 else COSTLY_MARKS) // 2
    early, even = np.geomspace(1, evaluations, count), np.linspace(1, evaluations, count)
    return tuple(np.unique(np.concatenate([early, even]).round().astype(int)).tolist())


def _least(told: Told, marks: tuple[int, ...]) -> tuple[float, ...]:
    """Running minimum of the first objective over the feasible designs."""
    values = np.where(told.feasible, told.F[:, 0], np.inf)
    running = np.minimum.accumulate(values) if len(values) else values
    return tuple(float(running[m - 1]) for m in marks)
