"""Front points simulated again by the model's reference, and the fronts marked with what came out."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TextIO

import numpy as np
import pyarrow as pa

from divideropt.analysis import Tally, combined_front, marked, summarise, tally
from divideropt.campaign.branches import stored_runs
from divideropt.campaign.config import Campaign
from divideropt.campaign.crew import Crew
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.hire import hired
from divideropt.campaign.interrupt import Interruption
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.neighbourhood import with_residuals
from divideropt.campaign.plan import build_problem, dividers
from divideropt.campaign.progress import Counter, say
from divideropt.campaign.reference import reference_problem
from divideropt.campaign.worker import STOP_FILE, simulate_again, warm_up
from divideropt.errors import DamagedFileError, NoFeasibleDesignError, UsageError
from divideropt.models.base import FloatArray
from divideropt.problem import Evaluations, Problem
from divideropt.store import Store, TableSchema


def verify_store(store: Store, workers: int | None, words: TextIO, again: str) -> Tally:
    """Verify every point of every front of a store, or go on where that stopped.

    Args:
        store: The store.
        workers: Processes at a time; the campaign's where None.
        words: Where progress is shown.
        again: The command that goes on if this one is stopped.

    Returns:
        The count over all points, each counted once.

    Raises:
        UsageError: There is no store, no front in it yet, or the model offers no reference.
        StoreInUseError: Another process writes to the store.
        StoreError: The store is damaged.
        DiskError: The disk refused.
        InterruptedRunError: A signal stopped it.
        WorkerLostError: Worker processes died again and again.
        NoFeasibleDesignError: The fronts are empty.
    """
    campaign = stored_campaign(store)
    problem = build_problem(campaign)
    interruption = Interruption(store.folder, again, store.status_folder / STOP_FILE)
    verifier = Verifier(campaign, problem, store, words, interruption)
    if not verifier.possible:
        raise UsageError(
            f"{store.folder}: the model offers no reference(), by which its results could be verified; "
            "`divideropt.models.Verifiable` says what it is"
        )
    with store.writing(), interruption.signals():
        changed = store.keep_fingerprint()
        if changed is not None:
            say(changed, words)
        fronts = _fronts(store, campaign, problem, verifier.schema, words)
        points = list(dict.fromkeys(name for front in fronts.values() for name in front["design_id"].to_pylist()))
        if not points:
            raise NoFeasibleDesignError(
                f"{store.folder}: no design is feasible, so the fronts are empty and there is nothing to verify; "
                "`divideropt status` says how the simulations ended"
            )
        warm_up(problem)
        with hired(campaign.parallel, workers or campaign.parallel.workers, store.folder) as crew:
            return tally(_distinct(verifier.verify(fronts, points, crew).values()), verifier.schema)


class Verifier:
    """Simulates front points of one store again; what it finds is kept, and no point is simulated a third time."""

    def __init__(
        self,
        campaign: Campaign,
        problem: Problem,
        store: Store,
        words: TextIO,
        interruption: Interruption,
    ) -> None:
        """Prepare; nothing is simulated yet.

        Args:
            campaign: As resolved.
            problem: Made from it.
            store: Its store, which the caller holds for writing.
            words: Where progress is shown.
            interruption: Hears the signals.

        Raises:
            UsageError: The model's reference is wrong.
        """
        self.schema = TableSchema.of(problem)
        self._text = dump_campaign(campaign)
        self._tolerance = campaign.verification.share
        self._problem, self._reference = problem, reference_problem(problem)
        self._store = store
        self._words, self._interruption = words, interruption

    @property
    def possible(self) -> bool:
        """Whether the model offers a reference."""
        return self._reference is not None

    def verify(self, fronts: Mapping[str, pa.Table], wanted: Sequence[str], crew: Crew | None) -> dict[str, pa.Table]:
        """Simulate points again, and write the fronts with what is known of each of theirs.

        Args:
            fronts: All the store's, by name.
            wanted: The `design_id` of the points; those simulated again before are not once more.
            crew: Who simulates; None for this process alone.

        Returns:
            The fronts as written.

        Raises:
            StoreError: What was kept is damaged, or of other designs.
            DiskError: The disk refused.
            InterruptedRunError: A signal stopped it; the fronts say what was known before.
            WorkerLostError: Worker processes died again and again.
        """
        log = self._store.verification(self.schema)
        known = log.table()
        written = self._write(fronts, known)
        if self._reference is None:
            say("the model offers no reference(), so the fronts say `verified: no`", self._words)
            return written
        before = set(known["design_id"].to_pylist())
        missing = [name for name in wanted if name not in before]
        if not missing:
            return written
        points = _named(_distinct(fronts.values()), missing)
        again = self._simulate(self._reference, self.schema.evaluations(points).designs, crew)
        fresh = [known]
        try:
            with Counter("verifying: {} of {} front points simulated again", len(missing), self._words) as counter:
                for row, evaluations in enumerate(again):
                    names, runs = (points.slice(row, 1)[key].to_pylist() for key in ("design_id", "run"))
                    fresh.append(self.schema.result_rows(names, runs, evaluations))
                    log.append(fresh[-1])
                    counter.advance()
        finally:
            log.flush()
        self._interruption.check()
        return self._write(fronts, pa.concat_tables(fresh))

    def _write(self, fronts: Mapping[str, pa.Table], known: pa.Table) -> dict[str, pa.Table]:
        made = {
            name: marked(front, known, self._problem, self.schema, self._tolerance) for name, front in fronts.items()
        }
        for name, front in made.items():
            self._store.write_front(name, front)
        return made

    def _simulate(self, reference: Problem, designs: FloatArray, crew: Crew | None) -> Iterator[Evaluations]:
        """Yield what the reference says of each design, in their order, until somebody asks to stop."""
        asked = self._until_stopped(designs)
        if crew is None:
            yield from (reference.simulate(design[None]) for design in asked)
            return
        if dividers(reference.model):  # a model of somebody's own has nothing of ours to compile
            warm_up(reference)
        with self._interruption.workers():
            yield from crew.map(simulate_again, ((self._text, design[None]) for design in asked))

    def _until_stopped(self, designs: FloatArray) -> Iterator[FloatArray]:
        for design in designs:
            if self._interruption.heard:
                return
            yield design


def _fronts(
    store: Store, campaign: Campaign, problem: Problem, schema: TableSchema, words: TextIO
) -> dict[str, pa.Table]:
    """Read the fronts, the combined one first, whose points are wanted most; from the logs where one is damaged."""
    names = ("combined", *(run.name for run in stored_runs(campaign, store)))
    try:
        found = {name: store.read_front(name, schema) for name in names}
    except DamagedFileError as error:
        say(f"{error}; here the fronts are made again", words)
        runs = {name: summarise(store.log(name, schema).read(), problem, schema).front for name in sorted(names[1:])}
        together = {"combined": combined_front(list(runs.values()), problem, schema), **runs}
        found = {**with_residuals(together, campaign, problem, store)}
    if found["combined"] is None:
        raise UsageError(f"{store.folder}: there are no fronts yet; run the campaign to its end first")
    return {name: front for name in names if (front := found[name]) is not None}  # in this order, made again or not


def _distinct(fronts: Iterable[pa.Table]) -> pa.Table:
    """List the points of several fronts, each once."""
    together = pa.concat_tables(fronts)
    _, first = np.unique(together["design_id"].to_pylist(), return_index=True)
    return together.take(pa.array(np.sort(first)))


def _named(points: pa.Table, names: Sequence[str]) -> pa.Table:
    place = {name: row for row, name in enumerate(points["design_id"].to_pylist())}
    return points.take(pa.array([place[name] for name in names]))
