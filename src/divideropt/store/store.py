"""A campaign's folder: the campaign as resolved, the runs' logs, the fronts, the report."""

from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from copy import copy
from datetime import UTC, datetime
from pathlib import Path

import pyarrow as pa

from divideropt.errors import DamagedFileError, StoreError, UsageError
from divideropt.store.campaign_file import read_campaign, write_campaign
from divideropt.store.endings import EndingRecord, read_ending, write_ending
from divideropt.store.files import (
    check_links,
    clear_temporaries,
    disk_errors,
    make_folder,
    publish,
    publish_folder,
)
from divideropt.store.fingerprint import keep_fingerprint, read_fingerprints
from divideropt.store.locks import held
from divideropt.store.log import RunLog
from divideropt.store.missing import instead_of
from divideropt.store.owner import Owner, holder
from divideropt.store.parts import Parts
from divideropt.store.schema import TableSchema
from divideropt.store.tables import check_replaceable, read_table, write_table

STUDIES = "sensitivity"
"""Where a campaign's store has its sensitivity studies, each a store in a folder of its own."""

LOCK_PATIENCE = 10.0
"""How long a run's log is waited for [s]: a worker outlives a killed parent by less."""


class Store:
    """The files of one campaign, see the layout in the design.

    While it is held for writing it knows its owner, also in other processes to which it is handed: they publish for
    that owner, as long as it holds the store.
    """

    def __init__(self, folder: Path) -> None:
        """Name the folder; nothing is read or made yet."""
        self.folder = folder
        self._owner: Owner | None = None

    def absolute(self) -> "Store":
        """Return the same store, with the same owner, by a name that holds in any working directory."""
        there = copy(self)
        there.folder = self.folder.resolve()
        return there

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
        return any((self.folder / "evaluations").glob("[!.]*/*.parquet"))

    @property
    def status_folder(self) -> Path:
        """What running processes say of themselves; of no interest once they are done."""
        return self.folder / ".running"

    @property
    def exists(self) -> bool:
        """Whether there is a store in the folder."""
        return self.campaign_path.is_file()

    def study(self, name: str) -> "Store":
        """Return the store of a sensitivity study of this campaign, there or not."""
        return Store(self._part_of_store(STUDIES, name))

    def studies(self) -> tuple["Store", ...]:
        """Return the stores of the studies that there are, by name."""
        folders = sorted((self.folder / STUDIES).glob("[!.]*"))
        return tuple(store for store in map(Store, folders) if store.exists and ".before-" not in store.folder.name)

    def read_campaign(self) -> str:
        """Return the campaign as resolved, YAML.

        Raises:
            UsageError: There is no store in the folder.
            StoreError: It cannot be read.
        """
        if not self.exists:
            raise UsageError(f"{self.folder}: no store there ({instead_of(self.folder)}")
        return read_campaign(self.campaign_path)

    def write_campaign(self, text: str) -> None:
        """Replace the campaign as resolved.

        Raises:
            DiskError: The disk refused.
        """
        make_folder(self.folder)
        write_campaign(self.campaign_path, text, self._check_owner)

    def write_report(self, text: str) -> Path:
        """Replace the report and return its path."""
        publish(self.report_path, lambda p: p.write_text(text, encoding="utf-8"))
        return self.report_path

    def has_log(self, run: str) -> bool:
        """Whether anything of a run is logged."""
        return any((self.folder / "evaluations" / run).glob("part-*.parquet"))

    def log(self, run: str, schema: TableSchema) -> RunLog:
        """Open a run's log.

        Raises:
            StoreError: A file is where a folder should be.
        """
        return RunLog(self._part_of_store("evaluations", run), run, schema, self._check_owner)

    def write_front(self, name: str, table: pa.Table) -> None:
        """Replace a front; `name` is a run's, or `combined`.

        Raises:
            DiskError: The disk refused; the front is as it was.
            StoreInUseError: The store is another's now.
        """
        path = self._front_path(name)
        way = publish if path.parent.exists() else publish_folder
        write_table(path, table, lambda path, write: way(path, write, self._check_owner))

    def read_front(self, name: str, schema: TableSchema) -> pa.Table | None:
        """Read a front, or None if it has not been written.

        Raises:
            DamagedFileError: It is damaged; it follows from the logs.
            StoreError: It is of another version, or not this campaign's.
        """
        path = self._front_path(name)
        if not path.exists():
            return None
        remedy = "it follows from the logs: delete it and run the campaign again"
        table = read_table(path, schema.front, remedy)
        objection = schema.front_objection(table)
        if objection is not None:
            raise DamagedFileError(f"{path}: damaged ({objection}); {remedy}")
        return table

    def write_ending(self, run: str, record: EndingRecord) -> None:
        """Keep how a run ended; see `divideropt.store.endings`."""
        with disk_errors(self._ending_path(run)):
            write_ending(self._ending_path(run), record, self._check_owner)

    def read_ending(self, run: str) -> EndingRecord | None:
        """Read how a run ended, or None if it has not, or not since this is kept.

        Raises:
            DamagedFileError: That is damaged; it follows from the log.
        """
        return read_ending(self._ending_path(run))

    def verification(self, schema: TableSchema) -> Parts:
        """Open the results of simulating front points again, in the order in which that was done."""
        folder = self._part_of_store("verification")
        remedy = f"restore it, or delete {folder}, and its points are simulated again"
        return Parts(folder, schema.results, remedy, lambda table, first: schema.objection(table), self._check_owner)

    def optimality(self, schema: TableSchema) -> Parts:
        """Open the results of simulating front points' neighbours, each under the `design_id` of its point."""
        folder = self._part_of_store("optimality")
        remedy = f"restore it, or delete {folder}, and the neighbours are simulated again"
        return Parts(folder, schema.results, remedy, lambda table, first: schema.objection(table), self._check_owner)

    def beside(self, schema: TableSchema) -> Parts:
        """Open the results of the other front's points: of the companion's in a campaign's store, and back."""
        folder = self._part_of_store("beside")
        remedy = f"restore it, or delete {folder}, and its points are simulated again"
        return Parts(folder, schema.results, remedy, lambda table, first: schema.objection(table), self._check_owner)

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Hold the store for writing: as long as this lasts, this process and those it hands the store to publish.

        Raises:
            StoreInUseError: Another process holds it.
            StoreError: A file is where a folder should be, or a later version of this program wrote here.
            DiskError: The disk refused.
        """
        with self._locked():
            self._make_ready()
            self._owner = Owner.here()
            self._owner.claim(self._owner_path)
            try:
                yield
            finally:
                self._owner.release(self._owner_path)
                self._owner = None

    def keep_fingerprint(self) -> str | None:
        """Keep what this process computes with; say what is other than with the last writer, None where nothing.

        Raises:
            DiskError: The disk refused.
        """
        return keep_fingerprint(self._writers_path, self._check_owner)

    def writers(self) -> tuple[dict[str, str], ...]:
        """Return what each computed with that wrote to the store, the latest last; none where that is not known."""
        return read_fingerprints(self._writers_path)

    @contextmanager
    def writing_run(self, run: str) -> Iterator[None]:
        """Hold one run's log for writing, waiting a little for a worker that is about to die.

        Raises:
            StoreInUseError: Another process keeps holding it.
        """
        with held(self.status_folder, f"{run}.lock", LOCK_PATIENCE, lambda: f"another process is writing run {run}"):
            yield

    def move_aside(self) -> Path | None:
        """Rename an existing store out of the way, and say where it went; None where there is none.

        Raises:
            UsageError: The folder holds something else, which is not ours to move.
        """
        if not self.exists:
            if self.folder.is_dir() and any(path.name != STUDIES for path in self.folder.iterdir()):
                raise UsageError(
                    f"{self.folder}: not a store (no campaign.yaml), and not empty; name another --store"
                )
            return None
        whole = self.folder.resolve()
        stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
        names = (f"{whole.name}.before-{stamp}{more}" for more in ("", *(f"-{i}" for i in range(2, 1000))))
        aside = next(path for path in map(whole.with_name, names) if not path.exists())
        with ExitStack() as held:
            for store in (self, *self._nested()):
                held.enter_context(store._locked())
            with disk_errors(self.folder):
                whole.rename(aside)
        return aside

    @property
    def _writers_path(self) -> Path:
        return self.folder / ".writers.json"

    @property
    def _owner_path(self) -> Path:
        return self.folder / ".owner"

    def _check_owner(self) -> None:
        """Make sure that the store is still held by whom this works for; nobody asks outside of `writing`."""
        if self._owner is not None:
            self._owner.check(self._owner_path)

    def _make_ready(self) -> None:
        """Find what would be in the way later, and clear what killed writers left."""
        logs = self._part_of_store("evaluations")
        parts = [self._part_of_store(name) for name in ("fronts", "verification", "endings", "optimality", "beside")]
        self._part_of_store(self.status_folder.name)
        runs = [self._part_of_store(logs.name, path.name) for path in logs.glob("[!.]*")]
        for folder in (self.folder, logs, *runs, *parts):
            clear_temporaries(folder)
        for front in sorted(parts[0].glob("[!.]*.parquet")):
            check_replaceable(front)
        check_links(self.folder)

    def _nested(self) -> "list[Store]":
        """The stores within this one, a folder or two below, which somebody may be writing to."""
        return [Store(path.parent) for depth in ("*", "*/*") for path in self.folder.glob(f"{depth}/campaign.yaml")]

    def _part_of_store(self, *names: str) -> Path:
        """Name a folder of the store, and make sure that neither it nor one above it is a file."""
        path = self.folder
        for name in names:
            path /= name
            if path.exists() and not path.is_dir():
                raise StoreError(f"{path}: a file where the store has a folder; move it out of the store")
        return path

    def _front_path(self, name: str) -> Path:
        return self._part_of_store("fronts") / f"{name}.parquet"

    def _ending_path(self, run: str) -> Path:
        return self._part_of_store("endings") / f"{run}.json"

    def _locked(self) -> AbstractContextManager[None]:
        def reason() -> str:
            return f"another divideropt is writing to this store: {holder(self._owner_path)}"

        return held(self.folder, ".lock", 0.0, reason)
