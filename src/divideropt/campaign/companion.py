"""A campaign with its companion, `nominal: true`: both run, then each one's front is simulated as the other's is."""

from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import pyarrow as pa

from divideropt.campaign.batches import Batches
from divideropt.campaign.beside import Side, both_sides
from divideropt.campaign.config import Campaign
from divideropt.campaign.crew import Crew
from divideropt.campaign.extend import check_endings, check_extends
from divideropt.campaign.hire import hired
from divideropt.campaign.interrupt import Interruption
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.progress import Counter, say
from divideropt.campaign.runner import Outcomes, Runner
from divideropt.campaign.worker import STOP_FILE, warm_up
from divideropt.errors import NoFeasibleDesignError
from divideropt.store import Store


@dataclass(frozen=True)
class Compared:
    """What a companion came to.

    Attributes:
        outcomes: What it left in its store; None where it found no feasible design.
        points: Designs of its front that were simulated under the whole campaign.
        feasible: How many of them are feasible there, too.
        simulated: Points of either front that this call simulated under the other's problem.
    """

    outcomes: Outcomes | None
    points: int
    feasible: int
    simulated: int


def run_campaign(
    campaign: Campaign,
    folder: Path,
    workers: int,
    words: TextIO,
    again: str,
    *,
    fresh: bool = False,
    branch: bool = False,
) -> tuple[Outcomes, Compared | None]:
    """Run a campaign and, where it asks for one, its companion; or go on where that stopped.

    Args:
        campaign: As resolved.
        folder: The store's.
        workers: Processes at a time, on this machine.
        words: Where progress is shown.
        again: The command that goes on if this one is stopped.
        fresh: Whether to move an existing store aside first, with the companion's in it.
        branch: Whether runs go on as new ones where their logs are no longer asked for.

    Returns:
        What came out of the campaign, and of its companion, None where it asks for none.

    Raises:
        DivideroptError: As `Runner.run`, of either; a companion without a feasible design is no error.
    """
    runner = Runner(campaign, folder, workers, words, again)
    if not campaign.nominal:
        return runner.run(fresh=fresh, branch=branch), None
    companion = Companion(campaign, Store(folder), workers, words, again)
    if not fresh:
        companion.check()
    try:
        done = runner.run(fresh=fresh, branch=branch)
    except NoFeasibleDesignError:
        companion.run(branch=branch)  # whose front says where the campaign asks too much
        raise
    return done, companion.run(branch=branch)


class Companion:
    """Runs the companion of one campaign, and simulates points of each one's front under the other's problem."""

    def __init__(self, campaign: Campaign, store: Store, workers: int, words: TextIO, again: str) -> None:
        """Prepare; nothing is read or made yet. Arguments as for `Runner`; `store` is the campaign's own."""
        self._own, self._nominal = both_sides(campaign, store)
        self._workers, self._words, self._again = workers, words, again
        self._interruption = Interruption(store.folder, again, store.status_folder / STOP_FILE)

    def check(self) -> None:
        """Find what is wrong with the companion's store before hours are spent on the campaign's.

        Raises:
            StoreError: It belongs to another campaign, or is damaged.
        """
        nominal = self._nominal
        if nominal.store.exists:
            check_extends(stored_campaign(nominal.store), nominal.campaign, nominal.store.folder)
            check_endings(nominal.campaign, nominal.problem, nominal.store)
        for side in (self._own, nominal):
            side.store.beside(side.schema).table()

    def run(self, *, branch: bool = False) -> Compared:
        """Run what is not yet in the companion's store, then simulate what is lacking of either front.

        Args:
            branch: Whether runs go on as new ones where their logs are no longer asked for.

        Raises:
            DivideroptError: As `Runner.run`, but for a companion without a feasible design.
        """
        folder = self._nominal.store.folder
        say(f"nominal: now the companion, without scenarios and uncertainty, in {folder}", self._words)
        outcomes = None
        try:
            runner = Runner(self._nominal.campaign, folder, self._workers, self._words, self._again)
            outcomes = runner.run(branch=branch)
        except NoFeasibleDesignError as error:
            say(f"nominal: {error}", self._words)
        simulated = self._simulate_both()
        points = self._nominal.points()
        found = self._own.schema.evaluations(self._own.known(points, self._nominal.schema))
        return Compared(outcomes, len(found), int(self._own.problem.tell(found).feasible.sum()), simulated)

    def _simulate_both(self) -> int:
        """Simulate what is lacking of either front; return how many points that were."""
        own, nominal = self._own, self._nominal
        with own.store.writing(), nominal.store.writing(), self._interruption.signals():
            lacking = [
                (own, _lacking(own, nominal), "of the companion's front under the whole campaign"),
                (nominal, _lacking(nominal, own), "of the campaign's front as the companion's are"),
            ]
            count = sum(int(points.num_rows) for _, points, _ in lacking)
            if count == 0:
                return 0
            with hired(own.campaign.parallel, self._workers, own.store.folder) as crew:
                for side, points, words in lacking:
                    if points.num_rows:
                        self._simulate(side, points, f"nominal: simulated {{}} of {{}} designs {words}", crew)
        return count

    def _simulate(self, side: Side, points: pa.Table, words: str, crew: Crew | None) -> None:
        """Simulate points of the other's front under a side's problem."""
        warm_up(side.problem)
        log = side.store.beside(side.schema)
        log.table()  # what is new comes after it
        ids, runs = points["design_id"].to_pylist(), points["run"].to_pylist()
        designs = (row[None] for row in points.select(side.schema.variables).to_pandas().to_numpy())
        batches = Batches(side.campaign, side.problem, self._interruption)
        try:
            with Counter(words, len(ids), self._words) as counter:
                for name, run, evaluations in zip(ids, runs, batches.simulate(designs, crew), strict=False):
                    log.append(side.schema.result_rows([name], [run], evaluations))
                    counter.advance()
        finally:
            log.flush()
        self._interruption.check()


def _lacking(side: Side, other: Side) -> pa.Table:
    """The points of the other's front that a side's problem has not been asked about yet."""
    points = other.points()
    known = set(side.known(points, other.schema)["design_id"].to_pylist())
    return points.filter(pa.array([name not in known for name in points["design_id"].to_pylist()], pa.bool_()))
