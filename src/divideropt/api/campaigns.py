"""Campaigns checked and run."""

import sys
from pathlib import Path
from typing import TextIO

import pandas as pd

from divideropt.api.given import Given, campaign_given
from divideropt.api.running import run_and_report
from divideropt.api.stores import Results
from divideropt.campaign.plan import plan_data


def check(campaign: Given) -> pd.DataFrame:
    """Read a campaign and say what it would run; `divideropt check`.

    Args:
        campaign: A file, the text of one, or a campaign that was read.

    Returns:
        A row a run: run, strategy, seed, and budget, the most evaluations it asks for.

    Raises:
        UsageError: The file cannot be read.
        FileMistakes: Everything wrong in it, with line and column.
    """
    return pd.DataFrame(plan_data(campaign_given(campaign))["runs"])


def run(
    campaign: Given,
    store: Path | str | None = None,
    *,
    workers: int | None = None,
    fresh: bool = False,
    branch: bool = False,
    words: TextIO | None = None,
) -> Results:
    """Run a campaign, or go on where its store stopped; write fronts and report; `divideropt run`.

    What is done is not done again, so that the same cell is safe whenever it is run. To be called in the main thread,
    since an interruption of the kernel is heard there: the work stops within 4 s, and where it cannot, the kernel
    ends; what was logged is in the store.

    Args:
        campaign: A file, the text of one, or a campaign that was read.
        store: Folder of the results; `results/NAME` where not given.
        workers: Processes at a time; the campaign's where not given.
        fresh: Whether to begin anew; an existing store is moved aside, not deleted.
        branch: Whether a run whose log this processor would not repeat to the bit goes on as a new one.
        words: Where progress is shown; standard error where not given.

    Returns:
        The results.

    Raises:
        FileMistakes: Everything wrong in the campaign, with line and column.
        StoreInUseError: Another process writes to the store.
        StoreError: The store is another campaign's, or damaged.
        NoFeasibleDesignError: No design is feasible; the report says why.
        IncompleteRunsError: Some runs were given up; `open` has the others.
        InterruptedRunError: It was interrupted; the same call goes on.
        DiskError: The disk refused.
    """
    asked = campaign_given(campaign)
    folder = Path("results") / asked.name if store is None else Path(store)
    stream = sys.stderr if words is None else words
    done = run_and_report(asked, folder, workers, stream, "divideropt.run, as before", fresh=fresh, branch=branch)
    done.check()
    return Results(folder)
