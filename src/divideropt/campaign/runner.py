"""Runs a campaign: its runs in parallel, then the fronts. The one stateful class of the campaign."""

import os
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import TextIO

import numpy as np
from joblib import Parallel, delayed, parallel_config
from joblib.externals.loky.process_executor import TerminatedWorkerError

from divideropt.analysis import combined_front, run_front
from divideropt.campaign.config import Campaign
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.execute import Simulate
from divideropt.campaign.extend import check_extends
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import Run, build_problem, plan_runs
from divideropt.campaign.progress import Display
from divideropt.campaign.worker import STOP_FILE, Ending, simulate_share, work, work_as_process
from divideropt.errors import DivideroptError, NoFeasibleDesignError, StoreError
from divideropt.models.base import FloatArray
from divideropt.problem import Evaluations, Problem
from divideropt.store import Store, TableSchema
from divideropt.store.files import disk_errors


class InterruptedRunError(DivideroptError):
    """A signal stopped the campaign; what was computed is on disk."""

    def __init__(self, number: int, folder: Path, again: str) -> None:
        """Word it for a signal, a store, and the command that goes on."""
        self.exit_code = 128 + number
        super().__init__(
            f"stopped by {signal.Signals(number).name}; everything computed is in {folder}. To go on:\n  {again}"
        )


class WorkerLostError(DivideroptError):
    """A worker process died; the exit code is that of a bug, since nothing of the user's made it."""


@dataclass(frozen=True)
class Outcomes:
    """What a campaign left in its store.

    Attributes:
        store: The store.
        front: Number of designs on the combined front.
    """

    store: Store
    front: int


class Runner:
    """Runs one campaign in one store."""

    def __init__(
        self, campaign: Campaign, folder: Path, workers: int, words: TextIO, again: str = "run the campaign again"
    ) -> None:
        """Prepare; nothing is read or made yet.

        Args:
            campaign: As resolved.
            folder: The store's.
            workers: Processes at a time.
            words: Where progress is shown.
            again: The command that goes on if this one is stopped.
        """
        self._campaign = campaign
        self._text = dump_campaign(campaign)
        self._again = again
        self._store = Store(folder)
        self._workers = 1 if campaign.parallel.backend == "sequential" else workers
        self._words = words
        self._signal: int | None = None

    def run(self, *, fresh: bool = False) -> Outcomes:
        """Run what is not yet in the store, and write the fronts.

        Args:
            fresh: Whether to move an existing store aside first.

        Returns:
            What came out.

        Raises:
            StoreInUseError: Another process writes to the store.
            StoreError: The store belongs to another campaign, or is damaged.
            DiskError: The disk refused.
            InterruptedRunError: A signal stopped it.
            WorkerLostError: A worker process died.
            NoFeasibleDesignError: No design is feasible.
        """
        aside = self._store.move_aside() if fresh else None
        if aside is not None:
            print(f"the old store is now {aside}", file=self._words)
        with self._store.writing(), self._signals():
            self._take_campaign()
            problem = build_problem(self._campaign)
            self._warm_up(problem)
            self._raise_first(self._drive(problem))
            return self._write_fronts(problem)

    def _take_campaign(self) -> None:
        """Check that the store is this campaign's, and write down what it has become."""
        if self._store.exists:
            if self._store.read_campaign() == self._text:
                return
            check_extends(stored_campaign(self._store), self._campaign, self._store.folder)
        elif self._store.has_logs:
            raise StoreError(
                f"{self._store.folder}: there are evaluations, but no campaign.yaml to say whose; restore it, "
                "or name another --store"
            )
        self._store.write_campaign(self._text)

    def _warm_up(self, problem: Problem) -> None:
        """Evaluate the middle of the box once, so that compiled code is in the cache before workers want it."""
        middle = (problem.space.lower + problem.space.upper) / 2
        problem.simulate(middle[None])

    def _drive(self, problem: Problem) -> list[Ending]:
        runs = plan_runs(self._campaign)
        folder = self._store.status_folder
        with disk_errors(folder):
            folder.mkdir(parents=True, exist_ok=True)
            for old in (folder / STOP_FILE, *folder.glob("*.json")):
                old.unlink(missing_ok=True)
        try:
            with Display(folder, [run.name for run in runs], self._words):
                return self._drive_with_workers(runs, problem)
        except TerminatedWorkerError as error:
            if self._signal is not None:  # which reached a worker before it could ignore it
                raise self._interrupted(self._signal) from error
            raise WorkerLostError(
                f"a worker process was killed, perhaps for want of memory. What was logged is intact. To go on:\n"
                f"  {self._again}"
            ) from error

    def _drive_with_workers(self, runs: Sequence[Run], problem: Problem) -> list[Ending]:
        if self._workers == 1:
            return [self._work_here(run, problem, problem.simulate) for run in runs]
        with parallel_config(backend="loky", inner_max_num_threads=1):
            if len(runs) < self._workers:
                return self._split_batches(runs, problem)
            return self._one_process_a_run(runs)

    def _one_process_a_run(self, runs: Sequence[Run]) -> list[Ending]:
        tasks = (delayed(work_as_process)(self._text, self._store.folder, run) for run in runs)
        pool = Parallel(n_jobs=self._workers, return_as="generator_unordered", batch_size=1, pre_dispatch="all")
        return list(pool(tasks))

    def _split_batches(self, runs: Sequence[Run], problem: Problem) -> list[Ending]:
        """Do the runs one after the other, each batch shared out among the workers."""
        with Parallel(n_jobs=self._workers) as pool:

            def simulate(designs: FloatArray) -> Evaluations:
                if len(designs) < self._workers:
                    return problem.simulate(designs)
                shares = np.array_split(designs, self._workers)
                parts = pool(delayed(simulate_share)(self._text, share) for share in shares)
                return Evaluations(
                    designs,
                    np.concatenate([part.quantities for part in parts]),
                    [verdict for part in parts for verdict in part.verdicts],
                )

            return [self._work_here(run, problem, simulate) for run in runs]

    def _work_here(self, run: Run, problem: Problem, simulate: Simulate) -> Ending:
        return work(self._campaign, problem, self._store.folder, run, simulate)

    @contextmanager
    def _signals(self) -> Iterator[None]:
        """Turn the first SIGINT or SIGTERM into a request to stop; the second ends everything at once."""
        stop = self._store.status_folder / STOP_FILE

        def hear(number: int, frame: FrameType | None) -> None:
            if self._signal is not None:
                os._exit(128 + number)
            self._signal = number
            with suppress(OSError):  # a disk that refuses will be heard of soon enough
                stop.touch()

        old = {number: signal.signal(number, hear) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in old.items():
                signal.signal(number, handler)

    def _raise_first(self, endings: Sequence[Ending]) -> None:
        for ending in endings:
            if ending.error is not None:
                raise ending.error
        if self._signal is not None:
            raise self._interrupted(self._signal)

    def _interrupted(self, number: int) -> InterruptedRunError:
        return InterruptedRunError(number, self._store.folder, self._again)

    def _write_fronts(self, problem: Problem) -> Outcomes:
        schema = TableSchema.of(problem)
        fronts = []
        for name in sorted(run.name for run in plan_runs(self._campaign)):
            front = run_front(self._store.log(name, schema).table(), problem, schema)
            self._store.write_front(name, front)
            fronts.append(front)
        combined = combined_front(fronts, problem, schema)
        self._store.write_front("combined", combined)
        if combined.num_rows == 0:
            raise NoFeasibleDesignError(
                f"{self._store.folder}: no design is feasible; `divideropt status` says how the simulations ended. "
                "Widen the bounds of the variables, or loosen the constraints."
            )
        return Outcomes(self._store, combined.num_rows)
