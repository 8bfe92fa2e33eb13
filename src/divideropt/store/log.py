"""The evaluation log of one run: every evaluation in the order it was asked for, append-only."""

from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from divideropt.errors import StoreError
from divideropt.problem import Evaluations
from divideropt.store.parts import Parts
from divideropt.store.schema import TableSchema

_REMEDY = "restore it, or start anew (--fresh)"


class RunLog:
    """Reads and extends the parts of one run; each holds whole batches. One process writes to a run."""

    def __init__(self, folder: Path, run: str, schema: TableSchema) -> None:
        """Open a run's folder, which need not exist yet."""
        self._folder, self._run, self._schema = folder, run, schema
        self._parts = Parts(folder, schema.arrow, _REMEDY)
        self._batches = 0

    def replay(self) -> Iterator[Evaluations]:
        """Yield the logged batches in order, and make ready to append after the last.

        Raises:
            StoreError: A part is damaged, missing or not this run's.
        """
        self._batches = 0
        for table in self._parts.read():
            batches = table["batch"].to_numpy()
            for batch in range(self._batches, int(batches[-1]) + 1):
                rows = table.filter(pc.equal(table["batch"], batch))
                if rows.num_rows == 0:
                    raise StoreError(f"{self._folder}: batch {batch} is missing; {_REMEDY}")
                self._batches += 1
                yield self._schema.evaluations(rows)

    def append(self, evaluations: Evaluations) -> None:
        """Log a batch; it reaches the disk with the next flush.

        Raises:
            DiskError: The disk refused a flush.
        """
        self._parts.append(self._schema.log_rows(self._run, self._parts.rows, self._batches, evaluations))
        self._batches += 1

    def flush(self) -> None:
        """Publish what is pending as one part.

        Raises:
            DiskError: The disk refused; the log is as it was.
        """
        self._parts.flush()

    def table(self) -> pa.Table:
        """Read every part as one table.

        Raises:
            StoreError: A part is damaged, missing or not this run's.
        """
        return self._parts.table()
