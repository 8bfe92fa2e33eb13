"""What is kept of simulating front points again: a table in parts, like the log, and the columns of the fronts."""

from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from divideropt.analysis import marked
from divideropt.errors import StoreError
from divideropt.store import Store, TableSchema
from divideropt.store.tables import worded
from toy_model import toy_problem

PROBLEM = toy_problem()
SCHEMA = TableSchema.of(PROBLEM)


def rows(first: int, count: int):
    designs = PROBLEM.space.sample(count, np.random.default_rng(first))
    names = [f"nsga2-1/{first + i}" for i in range(count)]
    return SCHEMA.result_rows(names, ["nsga2-1"] * count, PROBLEM.simulate(designs))


def filled(folder: Path) -> list[Path]:
    """Keep three parts of four rows."""
    parts = Store(folder).verification(SCHEMA)
    for first in (0, 4, 8):
        parts.append(rows(first, 4))
        parts.flush()
    return sorted((folder / "verification").iterdir())


def read(folder: Path):
    return Store(folder).verification(SCHEMA).table()


def test_what_was_kept_is_read_back_and_grows(tmp_path):
    names = [path.name for path in filled(tmp_path)]
    assert names == ["part-000000000.parquet", "part-000000004.parquet", "part-000000008.parquet"]
    parts = Store(tmp_path).verification(SCHEMA)
    before = parts.table()
    parts.append(rows(12, 2))
    parts.flush()
    table = read(tmp_path)
    assert table["design_id"].to_pylist() == [f"nsga2-1/{i}" for i in range(14)]
    assert table.slice(0, 12).equals(before)
    assert table.slice(12).equals(rows(12, 2))


def test_a_missing_part_is_noticed(tmp_path):
    filled(tmp_path)[1].unlink()
    with pytest.raises(StoreError, match=r"part-000000008.*missing.*delete .*verification"):
        read(tmp_path)


def test_a_foreign_or_a_later_or_an_empty_part_is_refused_by_name(tmp_path):
    part = filled(tmp_path)[2]
    table = pq.read_table(part)
    for wrong, words in (
        (table.drop_columns(["x3"]), "columns are not this campaign's"),
        (table.replace_schema_metadata({b"divideropt.schema_version": b"9"}), "schema version 9"),
        (table.replace_schema_metadata({}), "not a table of this program"),
        (table.slice(0, 0), "no rows"),
    ):
        part.write_bytes(worded(wrong))
        with pytest.raises(StoreError, match=rf"part-000000008.*{words}"):
            read(tmp_path)


def test_a_damaged_part_is_refused_never_read_wrong(tmp_path):
    part = filled(tmp_path)[2]
    whole, honest = part.read_bytes(), read(tmp_path)
    random = np.random.default_rng(0)
    refused = 0
    for place in random.integers(0, len(whole), 60):
        damaged = bytearray(whole)
        damaged[place] ^= 1 << int(random.integers(8))
        part.write_bytes(damaged)
        try:
            assert read(tmp_path).equals(honest)
        except StoreError as error:
            refused += part.name in str(error)
    assert refused > 30
    part.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(StoreError, match="damaged"):
        read(tmp_path)


def test_a_front_has_the_columns_with_their_meaning_and_no_other(tmp_path):
    store = Store(tmp_path)
    front = marked(rows(0, 4), rows(0, 4).slice(2, 1), PROBLEM, SCHEMA, 0.01)
    store.write_front("nsga2-1", front)
    assert store.read_front("nsga2-1", SCHEMA).equals(front)
    found = pq.read_schema(tmp_path / "fronts" / "nsga2-1.parquet")
    assert found.names[-6:-3] == ["verified", "deviation_f1", "deviation_f2"]
    assert found.names[-3:] == ["kkt", "kkt_residual", "kkt_floor"]
    for name in found.names[-6:]:
        assert found.field(name).metadata[b"role"] == (b"optimality" if "kkt" in name else b"verification")
        assert found.field(name).metadata[b"description"]
    assert found.field("deviation_f2").metadata[b"unit"] == b""
    store.write_front("nsga2-1", front.drop_columns(["verified"]))
    with pytest.raises(StoreError, match="columns are not this campaign's"):
        store.read_front("nsga2-1", SCHEMA)
