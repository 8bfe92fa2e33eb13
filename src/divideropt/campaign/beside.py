"""A campaign and its companion side by side: points of one's front in the other's problem."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pyarrow as pa

from divideropt.analysis import combined_front, representatives, summarise
from divideropt.campaign.branches import stored_runs
from divideropt.campaign.config import Campaign
from divideropt.campaign.nominal import nominal_campaign
from divideropt.campaign.plan import build_problem
from divideropt.errors import DamagedFileError, StoreError
from divideropt.problem import Problem
from divideropt.store import Store, TableSchema

FOLDER = "nominal"
"""The companion's store, within its campaign's."""

MOST_POINTS = 200
"""Designs of either front that are simulated under the other's problem: enough for a picture of it, and with the
compiled valve some seconds beside the minutes of the runs."""


@dataclass(frozen=True)
class Side:
    """A campaign or its companion: what it asks for, and its store."""

    campaign: Campaign
    store: Store

    @cached_property
    def problem(self) -> Problem:
        """What is optimised."""
        return build_problem(self.campaign)

    @cached_property
    def schema(self) -> TableSchema:
        """The columns of its tables."""
        return TableSchema.of(self.problem)

    def front(self) -> pa.Table | None:
        """Its combined front, from the logs where the file is damaged; None before it has been written.

        Raises:
            StoreError: A log is damaged, or the front is not this campaign's.
        """
        try:
            return self.store.read_front("combined", self.schema)
        except DamagedFileError:
            names = sorted(run.name for run in stored_runs(self.campaign, self.store))
            logs = (self.store.log(name, self.schema).read() for name in names)
            return combined_front(
                [summarise(log, self.problem, self.schema).front for log in logs], self.problem, self.schema
            )

    def points(self) -> pa.Table:
        """The points that stand for its front, in the front's order: all of them up to `MOST_POINTS`."""
        front = self.front()
        if front is None:
            return self.schema.front.empty_table()
        names = set(representatives(front, self.problem, self.schema, MOST_POINTS))
        return front.filter(pa.array([name in names for name in front["design_id"].to_pylist()], pa.bool_()))

    def known(self, points: pa.Table, theirs: TableSchema) -> pa.Table:
        """Return what this problem makes of points of the other side's front, as far as they were simulated.

        Args:
            points: The points.
            theirs: The columns of the other's tables.

        Returns:
            Rows of `TableSchema.results`, in the points' order.

        Raises:
            StoreError: What was kept is damaged, or of other designs.
        """
        kept = self.store.beside(self.schema).table()
        place = {name: row for row, name in enumerate(kept["design_id"].to_pylist())}
        ids = points["design_id"].to_pylist()
        found = np.array([row for row, name in enumerate(ids) if name in place], dtype=np.int64)
        rows = kept.take(pa.array([place[ids[row]] for row in found], pa.int64()))
        mine = self.schema.evaluations(rows).designs
        asked = theirs.evaluations(points.take(pa.array(found))).designs
        differ = (mine != asked).any(axis=1)
        if differ.any():
            name = rows["design_id"][int(differ.argmax())]
            raise StoreError(
                f"{self.store.folder / 'beside'}: {name} there is another design than on the front; delete that "
                "folder, and its points are simulated again"
            )
        return rows


def both_sides(campaign: Campaign, store: Store) -> tuple[Side, Side]:
    """A campaign in its store, and its companion in the store within."""
    return Side(campaign, store), Side(nominal_campaign(campaign), Store(store.folder / FOLDER))
