"""Runs a campaign: its runs in parallel, then the fronts, of whose points some are verified and explored around."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import pyarrow as pa

from divideropt.analysis import (
    Convergence,
    Summary,
    Tally,
    combined_front,
    convergence,
    tally,
    worth_verifying,
)
from divideropt.campaign.attempts import Attempts
from divideropt.campaign.branches import active_runs, branch_off, stored_runs, summaries
from divideropt.campaign.config import Campaign
from divideropt.campaign.crew import Crew
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.ending import Reason, keep_branched, kept_ending
from divideropt.campaign.extend import check_endings, check_extends
from divideropt.campaign.hire import hired
from divideropt.campaign.interrupt import Interruption
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.neighbourhood import Neighbourhood, with_residuals
from divideropt.campaign.plan import Run, build_problem
from divideropt.campaign.progress import say
from divideropt.campaign.verify import Verifier
from divideropt.campaign.worker import STOP_FILE, Ending, warm_up
from divideropt.errors import BatchDiffersError, DamagedFileError, NoFeasibleDesignError, StoreError
from divideropt.problem import Problem
from divideropt.store import Store, TableSchema


@dataclass(frozen=True)
class Outcomes:
    """What a campaign left in its store.

    Attributes:
        store: The store.
        front: The designs on the combined front, counted.
        kkt: How near to stationary they are.
        logs: Each run's log, summed up.
        failures: Why runs were given up, by their names; empty where all came to their end.
        skipped: The runs that had come to their end before, and were only compared with their logs.
        explored: Points of the front that this call simulated again, or the neighbours of.
    """

    store: Store
    front: Tally
    kkt: Convergence
    logs: Mapping[str, Summary]
    failures: Mapping[str, str]
    skipped: tuple[str, ...]
    explored: int

    @property
    def nothing_new(self) -> bool:
        """Whether all was there before this call."""
        return set(self.skipped) == set(self.logs) and self.explored == 0


class Runner:
    """Runs one campaign in one store."""

    def __init__(
        self, campaign: Campaign, folder: Path, workers: int, words: TextIO, again: str = "run the campaign again"
    ) -> None:
        """Prepare; nothing is read or made yet.

        Args:
            campaign: As resolved.
            folder: The store's.
            workers: Processes at a time, on this machine.
            words: Where progress is shown.
            again: The command that goes on if this one is stopped.
        """
        self._campaign = campaign
        self._text = dump_campaign(campaign)
        self._store = Store(folder)
        self._interruption = Interruption(folder, again, self._store.status_folder / STOP_FILE)
        self._attempts = Attempts(campaign, self._text, self._store, self._interruption, words)
        self._workers = workers
        self._words = words

    def run(self, *, fresh: bool = False, branch: bool = False) -> Outcomes:
        """Run what is not yet in the store, write the fronts, verify some of their points and compute KKT residuals.

        Args:
            fresh: Whether to move an existing store aside first.
            branch: Whether a run goes on as a new one where its log is not what the strategy asks for.

        Returns:
            What came out.

        Raises:
            UsageError: The model's reference is wrong, or the cluster is not there or unfit.
            StoreInUseError: Another process writes to the store.
            StoreError: The store belongs to another campaign, or is damaged.
            DiskError: The disk refused.
            InterruptedRunError: A signal stopped it.
            WorkerLostError: Worker processes died again and again after the runs.
            NoFeasibleDesignError: No design is feasible.
        """
        problem = build_problem(self._campaign)
        verifier = Verifier(self._campaign, problem, self._store, self._words, self._interruption)
        with self._working(problem, fresh) as crew:
            before = self._explored(verifier.schema)
            skipped = self._closed() + self._done(problem)
            failures = self._drive(problem, crew, branch)
            logs, written = self._write_fronts(problem, verifier, crew, failures)
            combined = written["combined"]
            kkt, count = convergence(combined), tally(combined, verifier.schema)
            explored = self._explored(verifier.schema) - before
            return Outcomes(self._store, count, kkt, logs, failures, skipped, explored)

    def sample(self, *, fresh: bool = False) -> Mapping[str, str]:
        """Run what is not yet in the store, and make nothing of it: the designs of a study are no candidates.

        Args:
            fresh: Whether to move an existing store aside first.

        Returns:
            Why runs were given up, by their names; empty where all came to their end.

        Raises:
            DivideroptError: As `run` does, but for what comes after the runs.
        """
        problem = build_problem(self._campaign)
        with self._working(problem, fresh) as crew:
            self._done(problem)
            return self._drive(problem, crew, False)

    @contextmanager
    def _working(self, problem: Problem, fresh: bool) -> Iterator[Crew | None]:
        """Hold the store, made ready for the campaign, and have workers until this is left."""
        aside = self._store.move_aside() if fresh else None
        if aside is not None:
            say(f"the old store is now {aside}", self._words)
        with self._store.writing(), self._interruption.signals():
            self._take_campaign(problem)
            changed = self._store.keep_fingerprint()
            if changed is not None:
                say(changed, self._words)
            with hired(self._campaign.parallel, self._workers, self._store.folder) as crew:
                warm_up(problem)
                yield crew

    def _take_campaign(self, problem: Problem) -> None:
        """Check that the store is this campaign's, and write down what it has become."""
        if self._store.exists:
            if self._store.read_campaign() == self._text:
                return
            check_extends(stored_campaign(self._store), self._campaign, self._store.folder)
            check_endings(self._campaign, problem, self._store)
        elif self._store.has_logs:
            raise StoreError(
                f"{self._store.folder}: there are evaluations, but no campaign.yaml to say whose; restore it, "
                "or name another --store"
            )
        self._store.write_campaign(self._text)

    def _closed(self) -> tuple[str, ...]:
        """Name the runs that are gone on with as others."""
        active = active_runs(self._campaign, self._store)
        return tuple(run.name for run in stored_runs(self._campaign, self._store) if run not in active)

    def _done(self, problem: Problem) -> tuple[str, ...]:
        """Find the runs that have come to their end, as now asked for, and say so."""
        schema, runs = TableSchema.of(problem), active_runs(self._campaign, self._store)
        found = tuple(run.name for run in runs if self._has_ended(run, schema))
        if found and len(found) < len(runs):
            names = ", ".join(found)
            say(
                f"done before, and only compared with their logs: {len(found)} of {len(runs)} runs ({names})",
                self._words,
            )
        return found

    def _has_ended(self, run: Run, schema: TableSchema) -> bool:
        """Whether a run's log goes to the end that was kept of it; every part of it is read and checked."""
        try:
            logged = sum(part.num_rows for part in self._store.log(run.name, schema).read())
            ended = kept_ending(self._store, run, logged)
        except DamagedFileError:  # of the log's the replay says it, and the ending follows from the log
            return False
        return ended is not None and ended.reason != Reason.BRANCHED

    def _explored(self, schema: TableSchema) -> int:
        """How many points were simulated again, or the neighbours of; damage is said before hours are spent."""
        again, around = (kept(schema).table() for kept in (self._store.verification, self._store.optimality))
        return int(again.num_rows + around.num_rows)

    def _drive(self, problem: Problem, crew: Crew | None, branch: bool) -> Mapping[str, str]:
        """Do the runs; return why some were given up, by their names."""
        runs = active_runs(self._campaign, self._store)
        endings = self._attempts.endings(runs, problem, crew)
        if branch:
            self._interruption.check()
            branches = self._branches(runs, endings, TableSchema.of(problem))
            endings = [e for e in endings if not isinstance(e.error, BatchDiffersError)]
            endings += self._attempts.endings(branches, problem, crew) if branches else []
        self._raise_first(endings)
        return {ending.run: ending.failure for ending in endings if ending.failure is not None}

    def _branches(self, runs: Sequence[Run], endings: Sequence[Ending], schema: TableSchema) -> list[Run]:
        """Begin a branch of each run whose log and strategy part, and say so; one that has ended is left as it is."""
        found, planned = [], {run.name: run for run in runs}
        for error in (ending.error for ending in endings):
            if not isinstance(error, BatchDiffersError):
                continue
            origin = planned[error.run]
            if self._has_ended(origin, schema):
                say(f"{origin.name}: done; left as it is, though batch {error.batch} differs here", self._words)
                continue
            branch = branch_off(self._store, self._campaign, schema, origin, error.batch)
            logged = sum(part.num_rows for part in self._store.log(origin.name, schema).read())
            keep_branched(self._store, origin, branch, error.batch, logged)
            say(f"{origin.name}: goes on as {branch.name}, from its first {error.batch} batches", self._words)
            found.append(branch)
        return found

    def _raise_first(self, endings: Sequence[Ending]) -> None:
        for ending in endings:
            if ending.error is not None:
                raise ending.error
        self._interruption.check()

    def _write_fronts(
        self, problem: Problem, verifier: Verifier, crew: Crew | None, failures: Mapping[str, str]
    ) -> tuple[dict[str, Summary], dict[str, pa.Table]]:
        """Write the fronts, marked with what is known of them; return them, and each run's log summed up."""
        schema = verifier.schema
        logs = dict(sorted(summaries(self._campaign, self._store, problem, schema).items()))
        fronts = {name: log.front for name, log in logs.items()}
        combined = combined_front(list(fronts.values()), problem, schema)
        asked = self._campaign.verification
        wanted = worth_verifying(combined, problem, schema, asked.sample, extremes=asked.extremes)
        known = with_residuals(fronts | {"combined": combined}, self._campaign, problem, self._store)
        explorer = Neighbourhood(self._campaign, problem, self._store, self._words, self._interruption)
        written = explorer.explore(verifier.verify(known, wanted, crew), crew)
        if combined.num_rows == 0 and not failures:
            raise NoFeasibleDesignError(
                f"{self._store.folder}: no design is feasible; `divideropt status` says how the simulations ended. "
                "Widen the bounds of the variables, or loosen the constraints."
            )
        return logs, written
