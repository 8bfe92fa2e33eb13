"""A store's evaluations and fronts as tables elsewhere: the work of `divideropt export`.

Parts of the logs are read, checked and written one after the other, so that no more than a part is in memory.
"""

import csv
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.csv as pc
import pyarrow.parquet as pq

from divideropt.campaign.beside import Side
from divideropt.campaign.branches import stored_runs
from divideropt.campaign.load import stored_campaign
from divideropt.errors import UsageError
from divideropt.store import Store
from divideropt.store.files import publish_tree

COLUMNS = "columns.csv"
"""Says of every column of the CSV files what it is."""

_ABOUT = ("unit", "symbol", "role", "description", "objective")
"""What the store knows of a column, by the keys of its metadata."""

Rows = Callable[[pa.Table], object]
"""Writes rows to a file that is open."""


@dataclass(frozen=True)
class Exported:
    """What was written.

    Attributes:
        folder: Where to.
        evaluations: Rows of its table of evaluations.
        fronts: Rows of each front, by the front's name; empty before the campaign has come to its end.
    """

    folder: Path
    evaluations: int
    fronts: Mapping[str, int]


def export_store(store: Store, kind: str, out: Path | None = None) -> Exported:
    """Write a store's evaluations and fronts as tables into a folder, which appears with all of them or not at all.

    Args:
        store: The store, also one that is being written to.
        kind: csv or parquet: `evaluations.csv`, every evaluation run by run in the campaign's order and in each as
            they were asked for, and `fronts/<name>.csv`, with `columns.csv`, which says what the columns are; or the
            same in parquet, where each column's metadata say it.
        out: The folder, which is not there yet, or empty; `<store>-csv` or `<store>-parquet` where not given.

    Returns:
        What was written. Numbers are SI, percentages in percent, and read back to the bit; a quantity that is not
        defined is an empty cell, or null.

    Raises:
        UsageError: There is no store, the format is neither, or the folder is there already or within a store.
        StoreError: A log or a front is damaged; nothing is written.
        DiskError: The disk refused; nothing is written.
    """
    if kind not in _WRITERS:
        raise UsageError(f"export: {kind!r} is no format; there are {' and '.join(_WRITERS)}")
    side = Side(stored_campaign(store), store)
    whole = store.folder.resolve()
    folder = store.folder.parent / f"{whole.name}-{kind}" if out is None else out
    check_outside(folder)
    counts: dict[str, int] = {}
    publish_tree(folder, partial(_write_tables, side, kind, counts))
    evaluations = counts.pop("")
    return Exported(folder, evaluations, counts)


def check_outside(out: Path) -> None:
    """Refuse to write into a store.

    Raises:
        UsageError: It is within one.
    """
    whole = out.resolve()
    for path in (whole, *whole.parents):
        if (path / "campaign.yaml").is_file() and (path / "evaluations").is_dir():
            raise UsageError(f"--out {out}: that is inside the store {path}; name a folder elsewhere")


def _write_tables(side: Side, kind: str, counts: dict[str, int], folder: Path) -> None:
    """Write every table into a folder that is there, and count their rows; of the evaluations under no name."""
    schema, runs = side.schema, [run.name for run in stored_runs(side.campaign, side.store)]
    parts = (part for run in runs for part in side.store.log(run, schema).read())
    counts[""] = _write_table(folder / f"evaluations.{kind}", schema.arrow, parts, kind)
    (folder / "fronts").mkdir()
    for name in ("combined", *runs):
        front = side.store.read_front(name, schema)
        if front is not None:
            counts[name] = _write_table(folder / "fronts" / f"{name}.{kind}", schema.front, [front], kind)
    if kind == "csv":
        with (folder / COLUMNS).open("w", encoding="utf-8", newline="") as file:
            _write_columns(file, {"evaluations": schema.arrow, "fronts": schema.front})
            _force(file)


def _write_table(path: Path, schema: pa.Schema, parts: Iterable[pa.Table], kind: str) -> int:
    count = 0
    with path.open("wb") as file:
        with _WRITERS[kind](file, schema) as write:
            for part in parts:
                write(part)
                count += part.num_rows
        _force(file)
    return count


@contextmanager
def _csv(file: Any, schema: pa.Schema) -> Iterator[Rows]:
    file.write(",".join(_quoted(name) for name in schema.names).encode() + b"\n")
    plain = pc.WriteOptions(include_header=False, quoting_style="needed")
    yield lambda table: pc.write_csv(table, file, plain)


@contextmanager
def _parquet(file: Any, schema: pa.Schema) -> Iterator[Rows]:
    with pq.ParquetWriter(file, schema) as writer:
        yield writer.write_table


_WRITERS: Mapping[str, Callable[[Any, pa.Schema], AbstractContextManager[Rows]]] = {"csv": _csv, "parquet": _parquet}


def _write_columns(file: Any, schemas: Mapping[str, pa.Schema]) -> None:
    rows = csv.writer(file, lineterminator="\n")
    rows.writerow(["table", "column", *_ABOUT])
    for table, schema in schemas.items():
        for field in schema:
            about = {key.decode(): value.decode() for key, value in (field.metadata or {}).items()}
            rows.writerow([table, field.name, *(about.get(key, "") for key in _ABOUT)])


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"' if any(c in name for c in ',"\r\n') else name


def _force(file: Any) -> None:
    file.flush()
    os.fsync(file.fileno())
