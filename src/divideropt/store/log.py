"""The evaluation log of one run: every evaluation in the order it was asked for, append-only."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from divideropt.problem import Evaluations
from divideropt.store.files import Check
from divideropt.store.parts import Parts
from divideropt.store.schema import TableSchema

_REMEDY = "restore it, or start anew (--fresh)"


class RunLog:
    """Reads and extends the parts of one run; each holds whole batches. One process writes to a run."""

    def __init__(self, folder: Path, run: str, schema: TableSchema, allowed: Check) -> None:
        """Open a run's folder, which need not exist yet; `allowed` as for `Parts`."""
        self._run, self._schema = run, schema
        self._parts = Parts(folder, schema.arrow, _REMEDY, self._objection, allowed)
        self._batches = 0  # read or flushed
        self._pending: list[Evaluations] = []
        self._waiting = 0

    def replay(self) -> Iterator[Evaluations]:
        """Yield the logged batches in order, and make ready to append after the last; forget what is not on disk.

        Raises:
            StoreError: A part is damaged, missing or not this run's.
        """
        self._pending, self._waiting = [], 0
        for table in self._parts.read():
            whole = self._schema.evaluations(table)
            for begin, end in pairwise([*_starts(table["batch"].to_numpy()).tolist(), table.num_rows]):
                yield whole.part(begin, end)

    def append(self, evaluations: Evaluations) -> None:
        """Log a batch; it reaches the disk with the next flush.

        Raises:
            DiskError: The disk refused a flush.
        """
        designs, quantities = evaluations.designs.copy(), evaluations.quantities.copy()  # their owners may reuse them
        self._pending.append(Evaluations(designs, quantities, evaluations.verdicts))
        self._waiting += len(evaluations)
        if self._parts.due(self._waiting):
            self.flush()

    def begin(self, batches: Sequence[Evaluations]) -> None:
        """Publish the first batches of an empty log, as one part: all of them or none.

        Raises:
            DiskError: The disk refused; there is no log.
        """
        if batches:
            self._parts.append(self._schema.log_rows(self._run, 0, 0, batches))
            self._batches = len(batches)
        self._parts.flush()

    def flush(self) -> None:
        """Publish what is pending as one part.

        Raises:
            DiskError: The disk refused; the log is as it was.
        """
        if self._pending:
            rows = self._schema.log_rows(self._run, self._parts.rows, self._batches, self._pending)
            self._batches += len(self._pending)
            self._pending, self._waiting = [], 0
            self._parts.append(rows)
        self._parts.flush()

    def read(self) -> Iterator[pa.Table]:
        """Yield the parts in order, checked: what to use where a log may be long.

        Raises:
            StoreError: A part is damaged, missing or not this run's.
        """
        return self._parts.read()

    def table(self) -> pa.Table:
        """Read every part as one table.

        Raises:
            StoreError: A part is damaged, missing or not this run's.
        """
        return self._parts.table()

    def _objection(self, table: pa.Table, first: int) -> str | None:
        """Say what a part, whose first row is given, holds that this run cannot have logged there."""
        self._batches = 0 if first == 0 else self._batches
        batches = table["batch"].to_numpy()
        found = batches[_starts(batches)]
        expected = np.arange(self._batches, self._batches + len(found))
        if (found != expected).any():
            return f"batch {expected[(found != expected).argmax()]} is missing"
        self._batches += len(found)
        return self._schema.log_objection(table, self._run, first)


def _starts(batches: NDArray[np.int64]) -> NDArray[np.int64]:
    """First rows of the batches."""
    return np.flatnonzero(np.diff(batches, prepend=batches[0] - 1))
