"""The results of a campaign: its fronts with units, figures of them, its report."""

import sys
from pathlib import Path
from typing import TextIO

import pandas as pd
import plotly.graph_objects as go

from divideropt.analysis import Tally
from divideropt.api.designs import Simulated, simulate
from divideropt.api.frames import preformatted, stored_frame
from divideropt.api.given import listen
from divideropt.campaign.beside import Side
from divideropt.campaign.branches import stored_runs
from divideropt.campaign.config import Campaign
from divideropt.campaign.export import export_store
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.status import StoreStatus, read_status
from divideropt.campaign.verify import verify_store
from divideropt.errors import UsageError
from divideropt.report import write_report
from divideropt.report.data import read_report
from divideropt.report.figures import CHOSEN, SELECTION, front_3d, projections
from divideropt.store import Store


class Results:
    """A store, to be read; `divideropt.run` and `divideropt.open` return one."""

    def __init__(self, folder: Path | str) -> None:
        """Open a store.

        Raises:
            UsageError: There is none in the folder.
            StoreError: Its campaign is damaged.
        """
        listen()
        self._store = Store(Path(folder))
        self._side = Side(stored_campaign(self._store), self._store)

    def __repr__(self) -> str:
        """Say where it is."""
        return f"divideropt.open({str(self.folder)!r})"

    def _repr_html_(self) -> str:
        """Say in a notebook what was asked for, and what there is to do with it."""
        runs = ", ".join(run.name for run in stored_runs(self.campaign, self._store))
        return preformatted(
            f"{self!r}: {self.campaign.name}\n"
            f"runs: {runs}\n"
            f"variables: {', '.join(self.variables)}\n"
            f"objectives: {', '.join(self.objectives)}\n"
            ".front(), .plot_front(), .evaluations(run), .simulate(design_id), .status(), .verify(), .report(), "
            ".export()"
        )

    @property
    def folder(self) -> Path:
        """The store's folder."""
        return self._store.folder

    @property
    def campaign(self) -> Campaign:
        """The campaign as resolved."""
        return self._side.campaign

    @property
    def variables(self) -> list[str]:
        """The columns that vary: `results.front()[results.variables]` can be given to `divideropt.evaluate`."""
        return list(self.campaign.variables)

    @property
    def objectives(self) -> list[str]:
        """The columns that are minimised; where scenarios or samples count, with what is taken over them."""
        return list(self._side.schema.objectives)

    def front(self, run: str = "combined") -> pd.DataFrame:
        """Read the feasible non-dominated designs of all runs together, or of one.

        Args:
            run: Its name, nsga2-1 say.

        Returns:
            A row a design: `design_id`, variables, objectives, every other metric, outcome, and what is known of its
            verification and its KKT residual. SI; `attrs` has units, symbols and descriptions by column.

        Raises:
            UsageError: There is no such front, or none yet.
            StoreError: It is damaged.
        """
        self._check_run(run, "combined")
        table = self._side.front() if run == "combined" else self._store.read_front(run, self._side.schema)
        if table is None:
            raise UsageError(f"{self.folder}: there is no front yet; run the campaign to its end first")
        return stored_frame(table)

    def evaluations(self, run: str) -> pd.DataFrame:
        """Read every evaluation of a run in the order it was asked for; columns and `attrs` as of `front`.

        Raises:
            UsageError: There is no such run.
            StoreError: The log is damaged.
        """
        self._check_run(run)
        return stored_frame(self._store.log(run, self._side.schema).table())

    def plot_front(self, x: str | None = None, y: str | None = None) -> go.Figure:
        """Draw the combined front.

        Args:
            x: An objective; with `y` a projection is drawn, else the first three objectives, or the two there are.
            y: Another.

        Returns:
            A Plotly figure: a mark a strategy, units on every axis, the goals as dotted lines of a projection.

        Raises:
            UsageError: There is no front, or nothing to draw of these objectives.
            StoreError: The store is damaged.
        """
        data = read_report(self._store)
        if not data.front:
            raise UsageError(f"{self.folder}: no design is feasible yet, so there is no front to draw")
        if x is None and y is None and len(data.objectives) >= 3:
            figure = front_3d(data)
        else:
            names = self.objectives
            wanted = frozenset(name for name in ([x, y] if x or y else names[:2]) if name is not None)
            found = {frozenset(names[i] for i in pair): figure for pair, figure in projections(data)}
            if wanted not in found:
                pairs = "; ".join(" and ".join(sorted(pair)) for pair in found) or "none, there is one objective"
                raise UsageError(f"plot_front: no projection on {x} and {y}; name a pair of objectives: {pairs}")
            figure = found[wanted]
        figure.data = [trace for trace in figure.data if trace.name not in (SELECTION, CHOSEN)]  # a page fills these
        figure.update_layout(showlegend=True)
        return figure

    def simulate(self, design_id: str, *, scenario: str = "scenario") -> Simulated:
        """Simulate a design of the store again, with its response.

        Args:
            design_id: `<run>/<index>`, as every table has it.
            scenario: Under which of the campaign's scenarios.

        Raises:
            UsageError: There is no such design, or the campaign's model has no response.
        """
        log = self.evaluations(design_id.partition("/")[0])
        rows = log.loc[log["design_id"] == design_id, self.variables].to_dict("records")
        if not rows:
            raise UsageError(f"{self.folder}: there is no design {design_id} in the log; the front has `design_id`")
        return simulate({str(k): v for k, v in rows[0].items()}, campaign=self.campaign, scenario=scenario)

    def status(self) -> StoreStatus:
        """Say what is done, what is left, and the best so far; `divideropt status`.

        Raises:
            StoreError: The store is damaged.
        """
        return read_status(self._store)

    def verify(self, *, workers: int | None = None, words: TextIO | None = None) -> Tally:
        """Simulate every front point again, far more exactly; see `divideropt.verify`."""
        return verify(self.folder, workers=workers, words=words)

    def report(self, out: Path | str | None = None) -> Path:
        """Write the HTML report again, and say where it is; `divideropt report`.

        Args:
            out: Where to; `report.html` in the store where not given.

        Raises:
            StoreError: The store is damaged.
            DiskError: The disk refused.
        """
        return write_report(self._store, None if out is None else Path(out))

    def export(self, format: str = "csv", out: Path | str | None = None) -> Path:
        """Write evaluations and fronts as tables into a folder of their own; see `divideropt.export`."""
        return export_store(self._store, format, None if out is None else Path(out)).folder

    def _check_run(self, run: str, *others: str) -> None:
        known = [*others, *(planned.name for planned in stored_runs(self.campaign, self._store))]
        if run not in known:
            raise UsageError(f"{self.folder}: there is no run {run!r}; there are {', '.join(known)}")


def open(store: Path | str) -> Results:
    """Open the store of a campaign that was run, or is running.

    Raises:
        UsageError: There is no store in the folder.
        StoreError: Its campaign is damaged.
    """
    return Results(store)


def status(store: Path | str) -> StoreStatus:
    """Say what a store holds, what is left to do, and the best so far; `divideropt status`.

    Raises:
        UsageError: There is no store in the folder.
        StoreError: It is damaged.
    """
    return Results(store).status()


def export(store: Path | str, format: str = "csv", out: Path | str | None = None) -> Path:
    """Write a store's evaluations and fronts as tables into a folder of their own; `divideropt export`.

    Args:
        store: Its folder.
        format: csv or parquet.
        out: A folder that is not there yet; `<store>-csv` or `<store>-parquet` where not given.

    Returns:
        The folder: `evaluations`, `fronts/<name>`, and with CSV `columns.csv`, which says unit, symbol, role and
        description of each column; parquet has them in each column's metadata. SI, percentages in percent.

    Raises:
        UsageError: There is no store, the format is neither, or the folder is there already.
        StoreError: A log or a front is damaged; nothing is written.
        DiskError: The disk refused; nothing is written.
    """
    return Results(store).export(format, out)


def verify(store: Path | str, *, workers: int | None = None, words: TextIO | None = None) -> Tally:
    """Simulate every front point again, far more exactly, and mark the fronts; `divideropt verify`.

    Args:
        store: Its folder.
        workers: Processes at a time; the campaign's where not given.
        words: Where progress is shown; standard error where not given.

    Returns:
        How many points there are, how many came out the same, how many deviate, and the largest deviations.

    Raises:
        UsageError: There is no store, no front in it yet, or the model offers no reference.
        StoreInUseError: Another process writes to the store.
        StoreError: The store is damaged.
        InterruptedRunError: It was interrupted; the same call goes on.
    """
    opened = Results(store)
    kept = Store(opened.folder)
    count = verify_store(kept, workers, sys.stderr if words is None else words, "divideropt.verify, as before")
    write_report(kept)
    return count
