"""What each run did: its budget, how its simulations ended, how its hypervolume grew."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from divideropt.analysis import Summary, hypervolume_history, repeatable
from divideropt.campaign.ending import Ended
from divideropt.campaign.plan import Run
from divideropt.models import Outcome
from divideropt.models.base import FloatArray
from divideropt.problem import Told

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
        examples: A sentence of the first simulation that ended so.
        marks: Numbers of evaluations at which the histories are taken.
        hypervolumes: Hypervolume up to each mark; empty without a reference point.
        least: Least value of the first objective up to each mark, NaN before the first feasible design.
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
    examples: Mapping[str, str]
    marks: tuple[int, ...]
    hypervolumes: tuple[float, ...]
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


def read_run(run: Run, log: Summary, reference: FloatArray | None, ended: Ended | None) -> RunFacts:
    """Say what a run did.

    Args:
        run: As planned.
        log: Its evaluations so far.
        reference: The reference point, shape (k,), or None.
        ended: How it ended, None before it has.
    """
    told = log.told
    marks = _marks(log.evaluations, told.F.shape[1])
    volumes = () if reference is None else tuple(hypervolume_history(told, reference, marks))
    return RunFacts(
        run.name,
        run.strategy,
        run.seed,
        log.evaluations,
        run.budget,
        int(told.feasible.sum()),
        dict(sorted(log.outcomes.items(), key=lambda item: list(Outcome).index(Outcome(item[0])))),
        log.examples,
        marks,
        volumes,
        _least(told, marks),
        None if log.best is None else (log.best.row, log.best.value),
        "" if ended is None else ended.text,
    )


def _marks(evaluations: int, objectives: int) -> tuple[int, ...]:
    if evaluations == 0:
        return ()
    count = (MARKS if objectives < 5 else COSTLY_MARKS) // 2
    early, even = np.geomspace(1, evaluations, count), np.linspace(1, evaluations, count)
    return tuple(np.unique(np.concatenate([early, even]).round().astype(int)).tolist())


def _least(told: Told, marks: tuple[int, ...]) -> tuple[float, ...]:
    """Running minimum of the first objective over the feasible designs."""
    values = np.where(told.feasible, told.F[:, 0], np.inf)
    running = np.minimum.accumulate(values) if len(values) else values
    return tuple(float(running[m - 1]) if np.isfinite(running[m - 1]) else float("nan") for m in marks)
