"""The store: what is written is read back to the bit, and what is damaged is refused."""

import os
from dataclasses import replace

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

from divideropt.errors import DamagedFileError, DiskError, StoreError, StoreInUseError, UsageError
from divideropt.store import Parts, RunLog, Store, TableSchema
from divideropt.store.files import publish
from divideropt.store.tables import worded
from toy_model import Toy, toy_problem


@pytest.fixture(name="problem")
def _problem():
    return toy_problem()


def evaluations(problem, count, seed):
    return problem.simulate(problem.space.sample(count, np.random.default_rng(seed)))


def filled_log(store, problem, batches=5):
    log = store.log("nsga2-1", TableSchema.of(problem))
    written = [evaluations(problem, 7, seed) for seed in range(batches)]
    for batch in written:
        log.append(batch)
        log.flush()
    return written


def test_a_log_is_read_back_to_the_bit(tmp_path, problem):
    written = filled_log(Store(tmp_path), problem)
    read = list(Store(tmp_path).log("nsga2-1", TableSchema.of(problem)).replay())
    assert len(read) == len(written)
    for before, after in zip(written, read, strict=True):
        assert before.designs.tobytes() == after.designs.tobytes()
        assert np.array_equal(before.quantities, after.quantities, equal_nan=True)
        assert list(before.verdicts) == list(after.verdicts)


def test_a_log_goes_on_after_a_replay(tmp_path, problem):
    filled_log(Store(tmp_path), problem, batches=2)
    log = Store(tmp_path).log("nsga2-1", TableSchema.of(problem))
    list(log.replay())
    log.append(evaluations(problem, 3, 9))
    log.flush()
    table = Store(tmp_path).log("nsga2-1", TableSchema.of(problem)).table()
    assert table["design_id"].to_pylist() == [f"nsga2-1/{i}" for i in range(17)]
    assert table["batch"].to_pylist() == [0] * 7 + [1] * 7 + [2] * 3


def test_every_file_is_readable_by_pandas_alone_with_units_in_the_metadata(tmp_path, problem):
    filled_log(Store(tmp_path), problem)
    folder = tmp_path / "evaluations" / "nsga2-1"
    frame = pd.read_parquet(folder)
    assert list(frame.columns) == [
        "design_id", "run", "batch", "x1", "x2", "x3", "f1", "f2", "spare", "outcome", "outcome_text"
    ]  # fmt: skip
    assert len(frame) == 35
    assert frame["f2"].isna().sum() == (frame["outcome"] == "unsettled").sum() > 0
    schema = pq.read_schema(next(folder.glob("*.parquet")))
    assert schema.field("spare").metadata[b"unit"] == b"m"
    assert schema.field("spare").metadata[b"role"] == b"constraint"
    assert b"magnitude" in schema.field("f2").metadata[b"objective"]


def test_a_part_of_another_campaign_is_refused_by_name(tmp_path, problem):
    filled_log(Store(tmp_path), problem)
    part = next((tmp_path / "evaluations" / "nsga2-1").glob("*.parquet"))
    pq.write_table(pq.read_table(part).drop_columns(["x3"]), part)
    with pytest.raises(StoreError, match=part.name):
        list(Store(tmp_path).log("nsga2-1", TableSchema.of(problem)).replay())


def test_a_later_version_is_refused_by_number(tmp_path, problem):
    filled_log(Store(tmp_path), problem, batches=1)
    part = next((tmp_path / "evaluations" / "nsga2-1").glob("*.parquet"))
    table = pq.read_table(part)
    pq.write_table(table.replace_schema_metadata({b"divideropt.schema_version": b"99"}), part)
    with pytest.raises(StoreError, match="schema version 99, this program knows up to 2"):
        Store(tmp_path).log("nsga2-1", TableSchema.of(problem)).table()


def test_an_earlier_version_is_refused_by_number(tmp_path, problem):
    filled_log(Store(tmp_path), problem, batches=1)
    part = next((tmp_path / "evaluations" / "nsga2-1").glob("*.parquet"))
    table = pq.read_table(part)
    pq.write_table(table.replace_schema_metadata({b"divideropt.schema_version": b"1"}), part)
    with pytest.raises(StoreError, match="schema version 1, this program writes 2; go on with the divideropt that"):
        Store(tmp_path).log("nsga2-1", TableSchema.of(problem)).table()


def test_a_model_whose_names_are_those_of_other_columns_is_refused():
    model = Toy()
    model.quantities["verified"] = replace(model.quantities["spare"], name="verified")
    with pytest.raises(UsageError, match="verified: the model gives this name"):
        TableSchema.of(toy_problem(model))


def test_a_missing_part_is_noticed(tmp_path, problem):
    filled_log(Store(tmp_path), problem)
    sorted((tmp_path / "evaluations" / "nsga2-1").glob("*.parquet"))[2].unlink()
    for read in (RunLog.table, lambda log: list(log.replay())):
        with pytest.raises(StoreError, match=r"part-000000021.*the part before it is missing"):
            read(Store(tmp_path).log("nsga2-1", TableSchema.of(problem)))


def test_a_part_that_lost_a_batch_is_noticed(tmp_path, problem):
    log = Store(tmp_path).log("nsga2-1", TableSchema.of(problem))
    for seed in range(3):
        log.append(evaluations(problem, 7, seed))
    log.flush()
    part = next((tmp_path / "evaluations" / "nsga2-1").glob("*.parquet"))
    table = pq.read_table(part)
    part.write_bytes(worded(table.filter(pc.not_equal(table["batch"], 1))))
    with pytest.raises(StoreError, match="batch 1 is missing"):
        list(Store(tmp_path).log("nsga2-1", TableSchema.of(problem)).replay())


@pytest.mark.parametrize(
    ("column", "value", "words"),
    [
        ("outcome", "bogus", "an outcome 'bogus', which this program does not know"),
        ("design_id", "nsga2-1/1", "not the evaluations from nsga2-1/0 on"),
        ("run", "nsga2-2", "not the evaluations from nsga2-1/0 on"),
        ("batch", 7, "batch 0 is missing"),
        ("x2", None, "nsga2-1/3 has a variable that is no number"),
        ("x2", float("inf"), "nsga2-1/3 has a variable that is no number"),
        ("f1", 1.7e308, r"nsga2-1/3 has a quantity beyond 1e\+50 that is not infinite"),
    ],
)
def test_what_no_run_can_have_logged_is_refused_by_the_files_name(tmp_path, problem, column, value, words):
    filled_log(Store(tmp_path), problem, batches=1)
    part = next((tmp_path / "evaluations" / "nsga2-1").glob("*.parquet"))
    table = pq.read_table(part)
    place, cells = table.schema.get_field_index(column), table[column].to_pylist()
    for row in [3] if column in ("x2", "f1") else range(table.num_rows):
        cells[row] = value
    field = table.schema.field(place)
    part.write_bytes(worded(table.set_column(place, field, pa.array(cells, field.type))))
    log = Store(tmp_path).log("nsga2-1", TableSchema.of(problem))
    for read in (log.table, lambda: list(log.replay())):
        with pytest.raises(DamagedFileError, match=rf"{part.name}: damaged \({words}"):
            read()


def test_only_regular_files_are_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(UsageError, match="not a regular file"):
        publish(tmp_path / "pipe", lambda path: path.write_text("x"))
    (tmp_path / "target").write_text("old")
    (tmp_path / "link").symlink_to("target")
    publish(tmp_path / "link", lambda path: path.write_text("new"))
    assert (tmp_path / "target").read_text() == "new"
    assert (tmp_path / "link").is_symlink()


def test_a_damaged_part_is_refused_never_read_wrong(tmp_path, problem):
    filled_log(Store(tmp_path), problem, batches=1)
    schema = TableSchema.of(problem)
    part = next((tmp_path / "evaluations" / "nsga2-1").glob("*.parquet"))
    whole, honest = part.read_bytes(), Store(tmp_path).log("nsga2-1", schema).table()
    random = np.random.default_rng(0)
    for place in random.integers(0, len(whole), 60):
        damaged = bytearray(whole)
        damaged[place] ^= 1 << int(random.integers(8))
        part.write_bytes(damaged)
        try:
            read = Store(tmp_path).log("nsga2-1", schema).table()
        except StoreError as error:
            assert part.name in str(error)
        else:
            assert read.equals(honest)


def test_a_second_writer_is_refused(tmp_path):
    with (
        Store(tmp_path).writing(),
        pytest.raises(StoreInUseError, match="another divideropt"),
        Store(tmp_path).writing(),
    ):
        pass


def test_a_failed_write_leaves_the_old_file_and_no_other(tmp_path):
    path = tmp_path / "front.parquet"
    path.write_text("old")

    def fail(temporary):
        temporary.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(DiskError, match="No space left on device") as caught:
        publish(path, fail)
    assert caught.value.exit_code == 74
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["front.parquet"]


def test_an_old_store_is_moved_aside_not_deleted(tmp_path):
    folder = tmp_path / "store"
    Store(folder).write_campaign("name: x\n")
    aside = Store(folder).move_aside()
    assert not folder.exists()
    assert Store(aside).read_campaign() == "name: x\n"


@pytest.mark.parametrize(("rate", "most"), [(500, 80), (50_000, 70)])
def test_a_million_rows_are_few_parts(tmp_path, problem, monkeypatch, rate, most):
    now, written = [0.0], []
    monkeypatch.setattr("divideropt.store.parts.time.monotonic", lambda: now[0])
    monkeypatch.setattr("divideropt.store.parts.write_table", lambda path, table, _: written.append(table.num_rows))
    schema = TableSchema.of(problem)
    table = Parts(tmp_path / "x", schema.results, "restore it", lambda *_: None, lambda: None)
    batch = schema.result_rows(["a"] * 200, ["b"] * 200, evaluations(problem, 200, 1))
    for _ in range(5000):
        now[0] += 200 / rate
        table.append(batch)
    table.flush()
    assert sum(written) == 1_000_000
    assert len(written) < most
    assert max(written) / rate <= 61  # seconds that a kill may cost
