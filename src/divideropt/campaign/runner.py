"""Runs a campaign: its runs in parallel, then the fronts, of whose points some are verified and explored around."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
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
from divideropt.campaign.branches import active_runs, branch_off, stored_runs, summaries
from divideropt.campaign.config import Campaign
from divideropt.campaign.crew import Crew, ProcessDiedError
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.ending import Reason, keep_branched, kept_ending
from divideropt.campaign.execute import Simulate
from divideropt.campaign.extend import check_endings, check_extends
from divideropt.campaign.hire import hired
from divideropt.campaign.interrupt import Interruption
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.mishaps import RESTARTS, Mishaps
from divideropt.campaign.neighbourhood import Neighbourhood, with_residuals
from divideropt.campaign.plan import Run, build_problem, dividers
from divideropt.campaign.progress import Display, say
from divideropt.campaign.verify import Verifier
from divideropt.campaign.worker import STOP_FILE, Ending, simulate_share, warm_up, work, work_as_process
from divideropt.errors import BatchDiffersError, DamagedFileError, NoFeasibleDesignError, StoreError
from divideropt.models.base import FloatArray
from divideropt.problem import Evaluations, Problem
from divideropt.store import Store, TableSchema
from divideropt.store.files import disk_errors


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
        endings = self._endings(runs, problem, crew)
        if branch:
            self._interruption.check()
            branches = self._branches(runs, endings, TableSchema.of(problem))
            endings = [e for e in endings if not isinstance(e.error, BatchDiffersError)]
            endings += self._endings(branches, problem, crew) if branches else []
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

    def _endings(self, runs: Sequence[Run], problem: Problem, crew: Crew | None) -> list[Ending]:
        folder = self._store.status_folder
        with disk_errors(folder):
            folder.mkdir(parents=True, exist_ok=True)
            for old in (folder / STOP_FILE, *folder.glob("*.json")):
                old.unlink(missing_ok=True)
            for run in runs:  # where this process is alone, an earlier one may have died of the run
                Mishaps(folder, run.name).forget(deaths=crew is not None)
        self._interruption.check()
        with Display(folder, {run.name: run.budget for run in runs}, self._words) as display:
            if crew is None:
                return [self._persist(lambda run: self._work_here(run, problem), run, display) for run in runs]
            if len(runs) < crew.size:
                return self._share_batches(runs, problem, crew, display)
            return self._one_process_a_run(runs, crew, display)

    def _one_process_a_run(self, runs: Sequence[Run], crew: Crew, display: Display) -> list[Ending]:
        """Do the runs side by side, the longest first, so that no process is left alone with it in the end."""

        def attempt(run: Run) -> Ending:
            return crew.call(work_as_process, self._text, self._store.absolute(), run)

        longest = sorted(runs, key=lambda run: run.budget, reverse=True)
        waiting = [crew.submit(self._persist, attempt, run, display) for run in longest]
        return [ending.result() for ending in waiting]

    def _share_batches(self, runs: Sequence[Run], problem: Problem, crew: Crew, display: Display) -> list[Ending]:
        """Do the runs one after the other, each batch shared by threads, or by processes if threads gain nothing."""
        threaded = problem.on_threads(crew.size) if crew.here else None
        quick = bool(dividers(problem.model))

        def simulate(designs: FloatArray) -> Evaluations:
            if quick and len(designs) < crew.size:
                return problem.simulate(designs)
            shares = np.array_split(designs, min(len(designs), crew.size))
            waiting = [crew.submit(self._simulate_share, crew, share) for share in shares]
            return Evaluations.together([part.result() for part in waiting])

        def attempt(run: Run) -> Ending:
            return self._work_here(run, problem, simulate if threaded is None else threaded.simulate)

        return [self._persist(attempt, run, display) for run in runs]

    def _simulate_share(self, crew: Crew, share: FloatArray) -> Evaluations:
        """Have a share evaluated; where its process died, by one that expects that."""
        try:
            return crew.call(simulate_share, self._text, share)
        except ProcessDiedError:
            return crew.insist(simulate_share, self._text, share, True)

    def _persist(self, attempt: Callable[[Run], Ending], run: Run, display: Display) -> Ending:
        """Attempt a run; begin it anew from its log where its process dies or breaks down, three times."""
        reason = ""
        for number in range(RESTARTS + 1):
            if number > 0:
                display.say(f"{run.name}: {reason}; begun anew from its log, {number} of {RESTARTS}")
            try:
                return attempt(run)
            except ProcessDiedError as died:
                reason = str(died)
                if died.final:
                    break
            except Exception as error:  # a bug of ours, of a library or of a model, in this run alone
                reason = f"it broke down ({type(error).__name__}: {error})"
            if self._interruption.heard:
                return Ending(run.name, stopped=True)
        else:
            reason = f"{reason}, {RESTARTS + 1} times"
        Mishaps(self._store.status_folder, run.name).give_up(reason)
        display.say(f"{run.name}: given up: {reason}")
        return Ending(run.name, failure=reason)

    def _work_here(self, run: Run, problem: Problem, simulate: Simulate | None = None) -> Ending:
        return work(self._campaign, problem, self._store, run, simulate)

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
