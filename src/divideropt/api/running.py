"""A campaign run to its end, and its report written: what `divideropt run` and `divideropt.run` do."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from divideropt.campaign.companion import Compared, run_campaign
from divideropt.campaign.config import Campaign
from divideropt.campaign.runner import Outcomes
from divideropt.errors import IncompleteRunsError, NoFeasibleDesignError
from divideropt.report import write_report
from divideropt.store import Store


@dataclass(frozen=True)
class Finished:
    """What came of it.

    Attributes:
        outcomes: What the campaign left in its store.
        companion: What its companion came to; None where it asks for none.
        report: Where the report is.
        again: The command, or the call, that tries again what was given up.
    """

    outcomes: Outcomes
    companion: Compared | None
    report: Path
    again: str

    @property
    def nothing_new(self) -> bool:
        """Whether all was done before: nothing was simulated this time."""
        if self.companion is None:
            return self.outcomes.nothing_new
        nominal = self.companion.outcomes
        known = nominal is not None and nominal.nothing_new and self.companion.simulated == 0
        return known and self.outcomes.nothing_new

    def check(self) -> None:
        """Say which runs were given up.

        Raises:
            IncompleteRunsError: Some were.
        """
        failures, runs = dict(self.outcomes.failures), len(self.outcomes.logs)
        if self.companion is not None and self.companion.outcomes is not None:
            nominal = self.companion.outcomes
            failures |= {f"nominal/{name}": reason for name, reason in nominal.failures.items()}
            runs += len(nominal.logs)
        if failures:
            raise _incomplete(self.outcomes.store.folder, failures, runs, self.again)


def run_and_report(
    campaign: Campaign,
    folder: Path,
    workers: int | None,
    words: TextIO,
    again: str,
    *,
    fresh: bool = False,
    branch: bool = False,
) -> Finished:
    """Run what is not yet in a store, and write its report.

    Args:
        campaign: As resolved.
        folder: The store's.
        workers: Processes at a time, on this machine; the campaign's where None.
        words: Where progress is shown.
        again: The command, or the call, that goes on if this one is stopped.
        fresh: Whether to move an existing store aside first.
        branch: Whether runs go on as new ones where their logs are no longer asked for.

    Returns:
        What came of it; `Finished.check` raises where runs were given up.

    Raises:
        NoFeasibleDesignError: No design is feasible; the report is written.
        DivideroptError: As `run_campaign`.
    """
    processes = workers or campaign.parallel.workers
    try:
        done, companion = run_campaign(campaign, folder, processes, words, again, fresh=fresh, branch=branch)
    except NoFeasibleDesignError:
        write_report(Store(folder))
        raise
    return Finished(done, companion, write_report(done.store, logs=done.logs), again)


def _incomplete(folder: Path, failures: Mapping[str, str], runs: int, again: str) -> IncompleteRunsError:
    reasons = "\n  ".join(f"{name}: {reason}" for name, reason in failures.items())
    return IncompleteRunsError(
        f"{folder}: {len(failures)} of {runs} runs are incomplete; fronts and report hold what was logged:\n"
        f"  {reasons}\nTo try them again from their logs:\n  {again}"
    )
