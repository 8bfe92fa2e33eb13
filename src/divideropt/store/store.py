"""A campaign's folder: the campaign as resolved, the runs' logs, the fronts, the report."""

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

import pyarrow as pa
from filelock import FileLock, Timeout

from divideropt.errors import StoreError, StoreInUseError, UsageError
from divideropt.store.files import disk_errors, publish
from divideropt.store.log import RunLog
from divideropt.store.parts import Parts
from divideropt.store.schema import TableSchema
from divideropt.store.tables import read_table, write_table

LOCK_PATIENCE = 10.0
"""How long a run's log is waited for [s]: a worker outlives a killed parent by less."""


class Store:
    """The files of one campaign, see the layout in the design."""

    def __init__(self, folder: Path) -> None:
        """Name the folder; nothing is read or made yet."""
        self.folder = folder

    @property
    def campaign_path(self) -> Path:
        """The campaign as resolved."""
        return self.folder / "campaign.yaml"

    @property
    def report_path(self) -> Path:
        """The report."""
        return self.folder / "report.html"

    @property
    def has_logs(self) -> bool:
        """Whether any evaluation is logged."""
        return any((self.folder / "evaluations").glob("*/*.parquet"))

    @property
    def status_folder(self) -> Path:
        """What running processes say of themselves; of no interest once they are done."""
        return self.folder / ".running"

    @property
    def exists(self) -> bool:
        """Whether there is a store in the folder."""
        return self.campaign_path.is_file()

    def read_campaign(self) -> str:
        """Return the campaign as resolved, YAML.

        Raises:
            UsageError: There is no store in the folder.
            StoreError: It cannot be read.
        """
        if not self.exists:
            raise UsageError(f"{self.folder}: no store there (no campaign.yaml); name the folder of a store")
        try:
            return self.campaign_path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise StoreError(
                f"{self.campaign_path}: damaged ({error}); restore it, or start anew (--fresh)"
            ) from error

    def write_campaign(self, text: str) -> None:
        """Replace the campaign as resolved.

        Raises:
            DiskError: The disk refused.
        """
        with disk_errors(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)
        publish(self.campaign_path, lambda p: _write_text(p, text))

    def write_report(self, text: str) -> Path:
        """Replace the report and return its path."""
        publish(self.report_path, lambda p: _write_text(p, text))
        return self.report_path

    def log(self, run: str, schema: TableSchema) -> RunLog:
        """Open a run's log."""
        return RunLog(self.folder / "evaluations" / run, run, schema)

    def write_front(self, name: str, table: pa.Table) -> None:
        """Replace a front; `name` is a run's, or `combined`."""
        write_table(self._front_path(name), table)

    def read_front(self, name: str, schema: TableSchema) -> pa.Table | None:
        """Read a front, or None if it has not been written.

        Raises:
            StoreError: It is damaged, of another version, or not this campaign's.
        """
        path = self._front_path(name)
        return read_table(path, schema.front, "delete it and run the campaign again") if path.is_file() else None

    def verification(self, schema: TableSchema) -> Parts:
        """Open the results of simulating front points again, in the order in which that was done."""
        folder = self.folder / "verification"
        return Parts(folder, schema.results, f"restore it, or delete {folder}, and its points are simulated again")

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Hold the store for writing.

        Raises:
            StoreInUseError: Another process holds it.
        """
        with _held(self.folder, ".lock", 0.0, "another divideropt is writing to this store"):
            yield

    @contextmanager
    def writing_run(self, run: str) -> Iterator[None]:
        """Hold one run's log for writing, waiting a little for a worker that is about to die.

        Raises:
            StoreInUseError: Another process keeps holding it.
        """
        with _held(self.status_folder, f"{run}.lock", LOCK_PATIENCE, f"another process is writing run {run}"):
            yield

    def move_aside(self) -> Path | None:
        """Rename an existing store out of the way, and say where it went; None where there is none.

        Raises:
            UsageError: The folder holds something else, which is not ours to move.
        """
        if not self.exists:
            if self.folder.is_dir() and any(self.folder.iterdir()):
                raise UsageError(
                    f"{self.folder}: not a store (no campaign.yaml), and not empty; name another --store"
                )
            return None
        whole = self.folder.resolve()
        stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
        names = (f"{whole.name}.before-{stamp}{more}" for more in ("", *(f"-{i}" for i in range(2, 1000))))
        aside = next(path for path in map(whole.with_name, names) if not path.exists())
        with self.writing(), disk_errors(self.folder):
            whole.rename(aside)
        return aside

    def _front_path(self, name: str) -> Path:
        return self.folder / "fronts" / f"{name}.parquet"


def _write_text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


@contextmanager
def _held(folder: Path, name: str, patience: float, reason: str) -> Iterator[None]:
    """Hold a lock of the kernel's, which ends with the process that has it."""
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"{folder}: a file, not a folder; name another --store")
    with disk_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
        lock = FileLock(folder / name, timeout=patience)
        try:
            lock.acquire()
        except Timeout:
            raise StoreInUseError(f"{folder}: {reason}; wait until it is done, or name another --store") from None
    try:
        yield
    finally:
        lock.release()
