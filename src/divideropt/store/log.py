"""The evaluation log of one run: every evaluation in the order it was asked for, append-only."""

import time
from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from divideropt.errors import StoreError
from divideropt.problem import Evaluations
from divideropt.store.files import disk_errors, publish
from divideropt.store.schema import TableSchema, check_version

FLUSH_ROWS = 500
"""Rows that are worth a part of their own, or this share of the log where that is more, so that parts stay few."""

FLUSH_SHARE = 0.1

FLUSH_SECONDS = 2.0
"""How long an evaluation waits for its part, or a share of the time the run has taken, but never longer than"""

LONGEST_WAIT = 60.0
"""this [s], which is what a kill may cost."""


class RunLog:
    """Reads and extends the parts of one run.

    One process writes to a run; parts are immutable and hold whole batches.
    """

    def __init__(self, folder: Path, run: str, schema: TableSchema) -> None:
        """Open a run's folder, which need not exist yet."""
        self._folder = folder
        self._run = run
        self._schema = schema
        self._pending: list[pa.Table] = []
        self._rows, self._batches, self._flushed = 0, 0, 0
        self._opened = self._last_flush = time.monotonic()

    def replay(self) -> Iterator[Evaluations]:
        """Yield the logged batches in order, and make ready to append after the last.

        Raises:
            StoreError: A part is damaged, missing or not this run's.
        """
        for path in self._parts():
            table = self._read(path)
            batches = table["batch"].to_numpy()
            for batch in range(self._batches, int(batches[-1]) + 1):
                rows = table.filter(pc.equal(table["batch"], batch))
                if rows.num_rows == 0:
                    raise StoreError(f"{path}: batch {batch} is missing; restore the part, or start anew (--fresh)")
                self._batches += 1
                self._rows += rows.num_rows
                self._flushed = self._rows
                yield self._schema.evaluations(rows)

    def append(self, evaluations: Evaluations) -> None:
        """Log a batch; it reaches the disk with the next flush.

        Raises:
            DiskError: The disk refused a flush.
        """
        self._pending.append(self._schema.table(self._run, self._rows, self._batches, evaluations))
        self._rows += len(evaluations)
        self._batches += 1
        waiting = self._rows - self._flushed
        now = time.monotonic()
        patience = min(max(FLUSH_SECONDS, FLUSH_SHARE * (now - self._opened)), LONGEST_WAIT)
        if waiting >= max(FLUSH_ROWS, FLUSH_SHARE * self._flushed) or now - self._last_flush >= patience:
            self.flush()

    def flush(self) -> None:
        """Publish what is pending as one part.

        Raises:
            DiskError: The disk refused; the log is as it was.
        """
        if self._pending:
            table = pa.concat_tables(self._pending)
            with disk_errors(self._folder):
                self._folder.mkdir(parents=True, exist_ok=True)
            path = self._folder / f"part-{self._flushed:09d}.parquet"
            publish(path, lambda p: pq.write_table(table, p, write_page_checksum=True))
            self._pending = []
            self._flushed = self._rows
        self._last_flush = time.monotonic()

    def table(self) -> pa.Table:
        """Read every part as one table.

        Raises:
            StoreError: A part is damaged, missing or not this run's.
        """
        parts: list[pa.Table] = []
        rows = 0
        for path in self._parts():
            if path.stem != f"part-{rows:09d}":
                raise StoreError(f"{path}: the part before it is missing; restore it, or start anew (--fresh)")
            parts.append(self._read(path))
            rows += parts[-1].num_rows
        return pa.concat_tables(parts) if parts else self._schema.arrow.empty_table()

    def _parts(self) -> list[Path]:
        return sorted(self._folder.glob("part-*.parquet"))

    def _read(self, path: Path) -> pa.Table:
        """Read a part and check that it is whole and this campaign's."""
        try:
            table = pq.ParquetFile(path, page_checksum_verification=True).read()
        except (pa.ArrowException, OSError) as error:
            raise StoreError(f"{path}: damaged ({error}); restore it, or start anew (--fresh)") from error
        check_version(table.schema, path)
        if table.num_rows == 0 or not table.schema.equals(self._schema.arrow):
            raise StoreError(f"{path}: its columns are not this campaign's; start anew (--fresh)")
        return table
