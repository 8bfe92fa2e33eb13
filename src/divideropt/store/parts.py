"""A table that only grows, in files that never change: `part-<first row>.parquet`, one after the other."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pyarrow as pa

from divideropt.errors import DamagedFileError, StoreError
from divideropt.store.files import Check, Write, publish_folder, publish_once
from divideropt.store.tables import read_table, write_table

FLUSH_ROWS = 500
"""Rows that are worth a part of their own, or this share of the table where that is more, so that parts stay few."""

FLUSH_SHARE = 0.1

FLUSH_SECONDS = 2.0
"""How long a row waits for its part, or a share of the time since the table was opened, but never longer than"""

LONGEST_WAIT = 60.0
"""this [s], which is what a kill may cost."""


class Parts:
    """Reads and extends a table in parts. One process writes to it."""

    def __init__(
        self,
        folder: Path,
        schema: pa.Schema,
        remedy: str,
        objection: Callable[[pa.Table, int], str | None],
        allowed: Check,
    ) -> None:
        """Open a folder, which need not exist yet.

        Args:
            folder: Where the parts are.
            schema: The table's columns.
            remedy: What to do about a part that is damaged, missing or foreign, for the message.
            objection: Says of a part, whose first row is given, what is wrong with what it says; None where nothing.
            allowed: Raises where this process may not write to the store any more.
        """
        self._folder, self._schema, self._remedy = folder, schema, remedy
        self._objection, self._allowed = objection, allowed
        self._pending: list[pa.Table] = []
        self._rows = self._flushed = 0
        self._opened = self._last_flush = time.monotonic()

    @property
    def rows(self) -> int:
        """Rows read and appended so far."""
        return self._rows

    def read(self) -> Iterator[pa.Table]:
        """Yield the parts in order, and make ready to append after the last; what is not on disk is forgotten.

        Raises:
            StoreError: A part is damaged, missing, of another version or another campaign's.
        """
        self._pending = []
        self._rows = self._flushed = 0
        for path in sorted(self._folder.glob("part-*.parquet")):
            if path.name != self._name(self._rows):
                raise StoreError(f"{path}: the part before it is missing; {self._remedy}")
            table = read_table(path, self._schema, self._remedy)
            if table.num_rows == 0:
                raise DamagedFileError(f"{path}: damaged (it has no rows); {self._remedy}")
            objection = self._objection(table, self._rows)
            if objection is not None:
                raise DamagedFileError(f"{path}: damaged ({objection}); {self._remedy}")
            self._rows += table.num_rows
            self._flushed = self._rows
            yield table

    def table(self) -> pa.Table:
        """Read every part as one table.

        Raises:
            StoreError: As `read`.
        """
        parts = list(self.read())
        return pa.concat_tables(parts) if parts else self._schema.empty_table()

    def append(self, table: pa.Table) -> None:
        """Add rows; they reach the disk with the next flush.

        Raises:
            DiskError: The disk refused a flush.
        """
        self._pending.append(table)
        self._rows += table.num_rows
        if self.due():
            self.flush()

    def due(self, more: int = 0) -> bool:
        """Whether what is pending, and so many more rows that the caller keeps, should reach the disk now."""
        waiting = self._rows - self._flushed + more
        now = time.monotonic()
        patience = min(max(FLUSH_SECONDS, FLUSH_SHARE * (now - self._opened)), LONGEST_WAIT)
        return waiting >= max(FLUSH_ROWS, FLUSH_SHARE * self._flushed) or now - self._last_flush >= patience

    def flush(self) -> None:
        """Publish what is pending as one part; the folder appears with the first.

        Raises:
            DiskError: The disk refused; the table is as it was.
            StoreInUseError: The store is another's now.
        """
        if self._pending:
            write_table(self._folder / self._name(self._flushed), pa.concat_tables(self._pending), self._publish)
            self._pending = []
            self._flushed = self._rows
        self._last_flush = time.monotonic()

    def _publish(self, path: Path, write: Write) -> None:
        first = self._flushed == 0 and not self._folder.exists()
        (publish_folder if first else publish_once)(path, write, self._allowed)

    @staticmethod
    def _name(first: int) -> str:
        return f"part-{first:09d}.parquet"
