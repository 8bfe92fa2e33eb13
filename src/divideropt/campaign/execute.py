"""One run from beginning to end: the strategy asks, the log answers as far as it goes, then the model."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from divideropt.campaign.ending import Ended, Watch
from divideropt.campaign.plan import Run
from divideropt.errors import BatchDiffersError, StoreError
from divideropt.models.base import FloatArray
from divideropt.problem import Evaluations, Problem, Told, one_thread

Simulate = Callable[[FloatArray], Evaluations]


class StoppedError(Exception):
    """Somebody asked the run to stop; what it computed is on disk."""


class Log(Protocol):
    """What a run needs of its log; see `divideropt.store.RunLog`."""

    def replay(self) -> Iterator[Evaluations]:
        """Yield the logged batches in order."""
        ...

    def append(self, evaluations: Evaluations) -> None:
        """Log a batch."""
        ...

    def flush(self) -> None:
        """Publish what is pending."""
        ...


@dataclass(frozen=True)
class Progress:
    """Where a run is.

    Attributes:
        told: The latest batch.
        replayed: Whether it came from the log.
    """

    told: Told
    replayed: bool


def execute(
    run: Run,
    problem: Problem,
    log: Log,
    simulate: Simulate,
    report: Callable[[Progress], None],
    stopping: Callable[[], bool],
    reference: FloatArray | None = None,
) -> Ended:
    """Drive a run to its end: that of its budget, or where its termination says so.

    Args:
        run: What to run.
        problem: On what.
        log: Its log: answers first, and receives what is new.
        simulate: Evaluates what the log does not know.
        report: Hears of every batch.
        stopping: Asked after every new batch that does not end the run.
        reference: The hypervolume's reference point, shape (k,), if the campaign has one.

    Returns:
        Why it ended, and after how many evaluations.

    Raises:
        BatchDiffersError: The log holds another batch than the strategy asks for.
        StoreError: The log is damaged, or goes on where the run would have ended.
        DiskError: The disk refused; what was flushed is intact.
        StoppedError: `stopping` said yes; the log is flushed.
    """
    logged, watch = log.replay(), Watch(run, problem, reference)
    count = 0

    def evaluate(designs: FloatArray) -> Told:
        nonlocal count
        designs = np.ascontiguousarray(designs, dtype=np.float64)
        known = _replayed(logged, designs, run.name, count)
        count += 1
        if known is not None:
            told = problem.tell(known)
        else:
            fresh = simulate(designs)
            log.append(fresh)
            told = problem.tell(fresh)
        report(Progress(told, replayed=known is not None))
        ended = watch.hear(told)
        if ended is not None:
            raise _OverError(ended)
        if known is None and stopping():
            raise StoppedError
        return told

    try:
        ended = _run_out(run, problem, evaluate) or watch.no_more()
        if next(logged, None) is not None:
            raise StoreError(
                f"run {run.name}: the log goes on after {ended.evaluations} evaluations, where the run as now asked "
                f"for would have ended ({ended.text}); ask for what was asked before, or start anew (--fresh)"
            )
    finally:
        log.flush()
    return ended


class _OverError(Exception):
    """A rule of the termination ends the run; strategies let it pass."""

    def __init__(self, ended: Ended) -> None:
        super().__init__(ended.text)
        self.ended = ended


def _run_out(run: Run, problem: Problem, evaluate: Callable[[FloatArray], Told]) -> Ended | None:
    """Let the strategy ask until it asks for no more, or until a rule ends it: then return how."""
    try:
        with one_thread():
            run.options.run(problem, evaluate, run.seed)
    except _OverError as over:
        return over.ended
    return None


def _replayed(logged: Iterator[Evaluations], designs: FloatArray, run: str, count: int) -> Evaluations | None:
    """Take the next batch from the log, if there is one, and check that it is the one asked for."""
    batch = next(logged, None)
    if batch is None:
        return None
    if batch.designs.shape != designs.shape or batch.designs.tobytes() != designs.tobytes():
        raise BatchDiffersError(run, count)
    return batch
