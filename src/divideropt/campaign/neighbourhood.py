"""Neighbours of front points simulated, and the fronts marked with the KKT residuals that follow."""

from collections.abc import Mapping
from typing import TextIO

import pyarrow as pa

from divideropt.analysis import measured, neighbours, residuals, scales_of, worth_verifying
from divideropt.campaign.batches import Batches
from divideropt.campaign.config import Campaign
from divideropt.campaign.crew import Crew
from divideropt.campaign.interrupt import Interruption
from divideropt.campaign.progress import Counter
from divideropt.problem import Problem
from divideropt.store import Store, TableSchema

Fronts = Mapping[str, pa.Table]


def with_residuals(fronts: Fronts, campaign: Campaign, problem: Problem, store: Store) -> dict[str, pa.Table]:
    """Say of front points what is known of their residuals.

    A residual hangs on the combined front, by whose extents objectives count, and is computed afresh each time: so
    that a store that was extended, or stopped and gone on with, says what one says that was made in one go.

    Args:
        fronts: By name, `combined` among them.
        campaign: As resolved: it says of how many points.
        problem: Made from it.
        store: Its store.

    Raises:
        StoreError: What was kept is damaged, or of other designs.
    """
    schema = TableSchema.of(problem)
    points = _wanted(fronts["combined"], campaign, problem, schema)
    known = {}
    if points.num_rows:
        around = store.optimality(schema).table()
        known = residuals(points, around, scales_of(fronts["combined"], problem, schema), problem, schema)
    return {name: measured(front, known, schema) for name, front in fronts.items()}


class Neighbourhood:
    """Simulates the neighbours of front points of one store; what comes out is kept, and none is simulated again."""

    def __init__(
        self, campaign: Campaign, problem: Problem, store: Store, words: TextIO, interruption: Interruption
    ) -> None:
        """Prepare; nothing is simulated yet. Arguments as for `divideropt.campaign.verify.Verifier`."""
        self._campaign, self._problem, self._store = campaign, problem, store
        self._words, self._interruption = words, interruption
        self._schema = TableSchema.of(problem)
        self._simulate = Batches(campaign, problem, interruption).simulate

    def explore(self, fronts: Fronts, crew: Crew | None) -> dict[str, pa.Table]:
        """Simulate what is lacking for the residuals the campaign asks for, and write the fronts with them.

        Args:
            fronts: All the store's, by name.
            crew: Who simulates; None for this process alone.

        Returns:
            The fronts as written.

        Raises:
            StoreError: What was kept is damaged, or of other designs.
            DiskError: The disk refused.
            InterruptedRunError: A signal stopped it; the fronts say what was known before.
            WorkerLostError: Worker processes died again and again.
        """
        points = _wanted(fronts["combined"], self._campaign, self._problem, self._schema)
        log = self._store.optimality(self._schema)
        known = set(log.table()["design_id"].to_pylist())
        missing = points.filter(pa.array([name not in known for name in points["design_id"].to_pylist()], pa.bool_()))
        if missing.num_rows == 0:
            return dict(fronts)
        designs = self._schema.evaluations(missing).designs
        words = "optimality: neighbours of {} of {} front points simulated"
        try:
            with Counter(words, missing.num_rows, self._words) as counter:
                around = (neighbours(design, self._problem.space) for design in designs)
                for row, evaluations in enumerate(self._simulate(around, crew)):
                    name, run = (missing[key][row].as_py() for key in ("design_id", "run"))
                    count = len(evaluations)
                    log.append(self._schema.result_rows([name] * count, [run] * count, evaluations))
                    counter.advance()
        finally:
            log.flush()
        self._interruption.check()
        written = with_residuals(fronts, self._campaign, self._problem, self._store)
        for name, front in written.items():
            self._store.write_front(name, front)
        return written


def _wanted(front: pa.Table, campaign: Campaign, problem: Problem, schema: TableSchema) -> pa.Table:
    """The points of the combined front whose residuals the campaign asks for."""
    count = campaign.optimality.points
    names = set(worth_verifying(front, problem, schema, count)) if count else set()
    return front.filter(pa.array([name in names for name in front["design_id"].to_pylist()], pa.bool_()))
