"""Strategies compared, and parameters studied."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

import pandas as pd
import plotly.graph_objects as go

from divideropt.api.frames import preformatted, stored_frame
from divideropt.api.given import Given, campaign_given
from divideropt.campaign import compare as comparing
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_problem, plan_runs
from divideropt.campaign.study import Asked, check_home, run_study, study_of, study_store
from divideropt.report import comparison_data, comparison_table, comparison_text, read_study, study_text, write_study
from divideropt.report.comparison_figure import comparison_figure
from divideropt.report.study_figure import study_figure
from divideropt.store import Store, TableSchema


@dataclass(frozen=True, repr=False)
class Compared:
    """Strategies against each other."""

    found: comparing.Compared
    """What `divideropt.campaign.compare` returned."""

    def __str__(self) -> str:
        """Say it as the command does."""
        return comparison_text(self.found)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Say it so in a notebook, where lines are not to be broken."""
        return preformatted(str(self))

    @property
    def table(self) -> pd.DataFrame:
        """A row a run: store, strategy, run, evaluations, designs, every indicator; NaN where not defined."""
        return comparison_table(self.found)

    @property
    def data(self) -> dict[str, Any]:
        """All that is said, as `divideropt compare --json` has it."""
        return comparison_data(self.found)

    def plot(self) -> go.Figure:
        """Draw the indicators of each run, strategy by strategy."""
        return comparison_figure(self.found.comparison)


@dataclass(frozen=True, repr=False)
class Study:
    """A sensitivity study.

    Attributes:
        folder: Its store.
        report: Its page.
        table: Of `morris` and `sobol` the indices with their intervals, as in indices.parquet; of `oat` the designs.
        text: What the command says; "" of `oat`, whose page has it.
    """

    folder: Path
    report: Path
    table: pd.DataFrame
    text: str

    def __repr__(self) -> str:
        """Say what the command says, where the page is and what else there is."""
        words = self.text or f"{len(self.table)} designs, one parameter at a time"
        return f"{words}\nreport: {self.report}\n.table has the numbers, .plot() draws them"

    def _repr_html_(self) -> str:
        """Say it so in a notebook, where lines are not to be broken."""
        return preformatted(repr(self))

    def plot(self, quantity: str | None = None) -> go.Figure:
        """Draw what the parameters do.

        Args:
            quantity: To what; to the objectives where not given, of `oat` to the first of them.

        Returns:
            A Plotly figure: of `oat` the quantity over each parameter, a panel each; of `morris` σ against μ* and of
            `sobol` first-order and total indices with 95 % intervals, a panel a quantity.

        Raises:
            UsageError: The study has no numbers of this quantity.
            StoreError: Its store is damaged.
        """
        return study_figure(Store(self.folder), quantity)


def compare(*stores: Path | str, at: int | None = None) -> Compared:
    """Compare strategies over their seeds, in one store or several of one problem; `divideropt compare`.

    Args:
        stores: Their folders.
        at: After so many evaluations of each run; as many as all have where not given.

    Returns:
        The comparison; `print` says it as the command does.

    Raises:
        UsageError: There is no store, one is named twice, their problems differ, or no run has got so far.
        StoreError: A store is damaged.
        NoFeasibleDesignError: No design is feasible.
    """
    return Compared(comparing.compare_stores([Path(store) for store in stores], at))


def sensitivity(
    campaign: Given,
    method: str = "oat",
    *,
    parameters: Sequence[str] = (),
    samples: int | None = None,
    second_order: bool = True,
    study: str | None = None,
    store: Path | str | None = None,
    workers: int | None = None,
    fresh: bool = False,
    words: TextIO | None = None,
) -> Study:
    """Say which parameters matter; `divideropt sensitivity`.

    Args:
        campaign: A file, the text of one, or a campaign that was read.
        method: oat, morris or sobol.
        parameters: What is studied, `NAME` or `NAME=LOWER..UPPER`; what the campaign says where empty.
        samples: Points of a sweep, trajectories, or blocks of a Sobol study.
        second_order: Whether a Sobol study has indices of pairs, as far as the campaign asks for them.
        study: Name of the study's folder; the method where not given.
        store: Folder of the campaign's results; `results/NAME` where not given.
        workers: Processes at a time; the campaign's where not given.
        fresh: Whether to begin anew; an existing study is moved aside, not deleted.
        words: Where progress is shown; standard error where not given.

    Returns:
        The study, its page written.

    Raises:
        UsageError: A parameter, a range or a number of samples is wrong.
        FileMistakes: Everything wrong in the campaign, with line and column.
        StoreError: The store is another campaign's, or damaged.
        IncompleteRunsError: The run was given up.
        InterruptedRunError: It was interrupted; the same call goes on.
    """
    asked = campaign_given(campaign)
    wanted = study_of(asked, Asked(method, tuple(parameters), samples, not second_order))
    folder = Path("results") / asked.name if store is None else Path(store)
    check_home(Store(folder), asked)
    kept = study_store(Store(folder), method if study is None else study)
    stream = sys.stderr if words is None else words
    run_study(wanted, kept, workers, stream, "divideropt.sensitivity, as before", fresh=fresh)
    found = None if method == "oat" else read_study(kept)
    report = write_study(kept, data=found)
    if found is None:
        return Study(kept.folder, report, _designs(kept), "")
    return Study(kept.folder, report, found.indices, study_text(found))


def _designs(store: Store) -> pd.DataFrame:
    """Every design of a study that has no indices."""
    campaign = stored_campaign(store)
    schema = TableSchema.of(build_problem(campaign))
    return stored_frame(store.log(plan_runs(campaign)[0].name, schema).table())
