"""Runs a campaign: its runs in parallel, then the fronts, whose points of interest are verified."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
from joblib import Parallel, delayed, parallel_config

from divideropt.analysis import Summary, Tally, combined_front, summarise, tally, worth_verifying
from divideropt.campaign.config import Campaign
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.execute import Simulate
from divideropt.campaign.extend import check_extends
from divideropt.campaign.interrupt import Interruption
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import Run, build_problem, plan_runs
from divideropt.campaign.progress import Display, say
from divideropt.campaign.verify import Verifier
from divideropt.campaign.worker import STOP_FILE, Ending, simulate_share, warm_up, work, work_as_process
from divideropt.errors import NoFeasibleDesignError, StoreError
from divideropt.models.base import FloatArray
from divideropt.problem import Evaluations, Problem
from divideropt.store import Store
from divideropt.store.files import disk_errors


@dataclass(frozen=True)
class Outcomes:
    """What a campaign left in its store.

    Attributes:
        store: The store.
        front: The designs on the combined front, counted.
        logs: Each run's log, summed up.
    """

    store: Store
    front: Tally
    logs: Mapping[str, Summary]


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
        self._store = Store(folder)
        self._interruption = Interruption(folder, again, self._store.status_folder / STOP_FILE)
        self._workers = 1 if campaign.parallel.backend == "sequential" else workers
        self._words = words

    def run(self, *, fresh: bool = False) -> Outcomes:
        """Run what is not yet in the store, write the fronts, and verify some of their points.

        Args:
            fresh: Whether to move an existing store aside first.

        Returns:
            What came out.

        Raises:
            UsageError: The model's reference is wrong.
            StoreInUseError: Another process writes to the store.
            StoreError: The store belongs to another campaign, or is damaged.
            DiskError: The disk refused.
            InterruptedRunError: A signal stopped it.
            WorkerLostError: A worker process died.
            NoFeasibleDesignError: No design is feasible.
        """
        problem = build_problem(self._campaign)
        verifier = Verifier(self._campaign, problem, self._store, self._workers, self._words, self._interruption)
        aside = self._store.move_aside() if fresh else None
        if aside is not None:
            say(f"the old store is now {aside}", self._words)
        with self._store.writing(), self._interruption.signals():
            self._take_campaign()
            changed = self._store.keep_fingerprint()
            if changed is not None:
                say(changed, self._words)
            self._store.verification(verifier.schema).table()  # damage is said before hours are spent, not after
            warm_up(problem)
            self._raise_first(self._drive(problem))
            return self._write_fronts(problem, verifier)

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

    def _drive(self, problem: Problem) -> list[Ending]:
        runs = plan_runs(self._campaign)
        folder = self._store.status_folder
        with disk_errors(folder):
            folder.mkdir(parents=True, exist_ok=True)
            for old in (folder / STOP_FILE, *folder.glob("*.json")):
                old.unlink(missing_ok=True)
        self._interruption.check()
        with self._interruption.workers(), Display(folder, [run.name for run in runs], self._words):
            return self._drive_with_workers(runs, problem)

    def _drive_with_workers(self, runs: Sequence[Run], problem: Problem) -> list[Ending]:
        if self._workers == 1:
            return [self._work_here(run, problem, problem.simulate) for run in runs]
        with parallel_config(backend="loky", inner_max_num_threads=1):
            if len(runs) < self._workers:
                return self._share_batches(runs, problem)
            return self._one_process_a_run(runs)

    def _one_process_a_run(self, runs: Sequence[Run]) -> list[Ending]:
        """Do the runs side by side, the longest first, so that no process is left alone with it in the end."""
        longest = sorted(runs, key=lambda run: run.options.budget, reverse=True)
        tasks = (delayed(work_as_process)(self._text, self._store, run) for run in longest)
        pool = Parallel(n_jobs=self._workers, return_as="generator_unordered", batch_size=1, pre_dispatch="all")
        return list(pool(tasks))

    def _share_batches(self, runs: Sequence[Run], problem: Problem) -> list[Ending]:
        """Do the runs one after the other, each batch shared by threads, or by processes if threads gain nothing."""
        threaded = problem.on_threads(self._workers)
        if threaded is not None:
            return [self._work_here(run, threaded, threaded.simulate) for run in runs]
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
        return work(self._campaign, problem, self._store, run, simulate)

    def _raise_first(self, endings: Sequence[Ending]) -> None:
        for ending in endings:
            if ending.error is not None:
                raise ending.error
        self._interruption.check()

    def _write_fronts(self, problem: Problem, verifier: Verifier) -> Outcomes:
        schema = verifier.schema
        names = sorted(run.name for run in plan_runs(self._campaign))
        logs = {name: summarise(self._store.log(name, schema).read(), problem, schema) for name in names}
        fronts = {name: log.front for name, log in logs.items()}
        combined = combined_front(list(fronts.values()), problem, schema)
        wanted = worth_verifying(combined, problem, schema, self._campaign.verification.sample)
        written = verifier.verify(fronts | {"combined": combined}, wanted)
        if combined.num_rows == 0:
            raise NoFeasibleDesignError(
                f"{self._store.folder}: no design is feasible; `divideropt status` says how the simulations ended. "
                "Widen the bounds of the variables, or loosen the constraints."
            )
        return Outcomes(self._store, tally(written["combined"], schema), logs)
