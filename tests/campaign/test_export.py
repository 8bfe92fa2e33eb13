"""`divideropt export`: every row of a store as tables elsewhere, to the bit, whole or not at all."""

import csv
import errno
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner

from divideropt.campaign.export import export_store
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.cli import commands
from divideropt.errors import DamagedFileError, DiskError, NoFeasibleDesignError, UsageError
from divideropt.store import Store

CAMPAIGN = """
name: toy
model: {kind: "toy_model:CheckedToy"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2}}
constraints: {spare: {min: 0 m}}
strategies:
  nsga2: {population: 12, generations: 4, seeds: [2, 1]}
  complex: {points: 6, evaluations: 40, seeds: [1]}
verification: {sample: 3}
optimality: {points: 3}
parallel: {workers: 1, backend: sequential}
"""

LIMITED = """
import resource, signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000))
from divideropt.cli import main
main()
"""

RUNS = ["nsga2-2", "nsga2-1", "complex-1"]


def make(folder, text=CAMPAIGN):
    with (folder / "words").open("w") as words:
        Runner(parse_campaign(text), folder / "toy", 1, words).run()
    return folder / "toy"


@pytest.fixture(scope="module", name="whole")
def _whole(tmp_path_factory):
    return make(tmp_path_factory.mktemp("whole"))


@pytest.fixture(name="store")
def _store(whole, tmp_path):
    return Path(shutil.copytree(whole, tmp_path / "toy"))


def logged(store):
    """Every evaluation as pandas reads it from the store's own parts."""
    parts = [path for run in RUNS for path in sorted((store / "evaluations" / run).glob("*.parquet"))]
    return pd.concat([pd.read_parquet(path) for path in parts], ignore_index=True)


def read_csv(path):
    return pd.read_csv(path, engine="python", keep_default_na=False, na_values=[""])  # by Python's own `float`


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_tables_hold_every_row_in_order_and_to_the_bit(store, kind):
    before = {path: path.stat().st_mtime_ns for path in store.rglob("*")}
    done = export_store(Store(store), kind)
    assert {path: path.stat().st_mtime_ns for path in store.rglob("*")} == before
    assert done.folder == store.with_name(f"toy-{kind}")
    assert done.evaluations == 48 + 48 + 40
    read = read_csv if kind == "csv" else pd.read_parquet
    found = {"evaluations": (read(done.folder / f"evaluations.{kind}"), logged(store))}
    for name in ("combined", *RUNS):
        stored = pd.read_parquet(store / "fronts" / f"{name}.parquet")
        found[name] = read(done.folder / "fronts" / f"{name}.{kind}"), stored
        assert done.fronts[name] == len(stored) > 0
    for name, (mine, stored) in found.items():
        assert list(mine) == list(stored)
        for column in stored:
            if stored[column].dtype == float:
                assert mine[column].to_numpy(float).tobytes() == stored[column].to_numpy().tobytes(), (name, column)
            else:
                words = mine[column].astype(object).fillna("")
                assert words.tolist() == stored[column].tolist(), (name, column)


def test_parquet_has_the_stores_metadata_and_csv_a_table_of_them(store):
    parquet, plain = (export_store(Store(store), kind).folder for kind in ("parquet", "csv"))
    front = pq.read_schema(store / "fronts" / "combined.parquet")
    assert pq.read_schema(parquet / "fronts" / "combined.parquet").equals(front, check_metadata=True)
    rows = list(csv.DictReader((plain / "columns.csv").read_text(encoding="utf-8").splitlines()))
    fronts = {row["column"]: row for row in rows if row["table"] == "fronts"}
    assert list(fronts) == front.names
    assert [row["column"] for row in rows if row["table"] == "evaluations"] == list(logged(store))
    assert (fronts["spare"]["unit"], fronts["spare"]["role"]) == ("m", "constraint")
    assert fronts["f2"]["objective"] == "acts on the magnitude; the column is signed"
    assert not (parquet / "columns.csv").exists()


def test_a_front_goes_straight_into_evaluate(store, monkeypatch):
    monkeypatch.chdir(store.parent)
    Path("toy.yaml").write_text(CAMPAIGN)
    run = CliRunner()
    said = json.loads(run.invoke(commands, ["export", "toy", "--json"]).stdout)
    assert (said["folder"], said["evaluations"]) == ("toy-csv", 136)
    done = run.invoke(
        commands, ["evaluate", "toy-csv/fronts/combined.csv", "--campaign", "toy.yaml", "--out", "r.csv"]
    )
    assert done.exit_code == 0, done.exception
    assert "columns of results are passed over: run, …" in done.stderr
    front, again = read_csv("toy-csv/fronts/combined.csv"), read_csv("r.csv")
    for column in ("design_id", "x1", "x2", "x3", "f1", "f2", "spare", "outcome"):
        assert again[column].tolist() == front[column].tolist()
    more = run.invoke(commands, ["evaluate", "r.csv", "--campaign", "toy/campaign.yaml"])  # its own output, too
    assert more.stdout == Path("r.csv").read_text()


def test_nothing_is_replaced_and_nothing_goes_into_a_store(store, tmp_path):
    (tmp_path / "there").mkdir()
    export_store(Store(store), "csv", tmp_path / "there")  # an empty folder is as good as none
    before = sorted(tmp_path.rglob("*"))
    for out, words in (
        (tmp_path / "there", "is there already, and is not replaced"),
        (store / "fronts" / "more", "inside the store"),
        (store, "inside the store"),
        (tmp_path / "no" / "where", "there is no folder"),
    ):
        with pytest.raises(UsageError, match=words):
            export_store(Store(store), "parquet", out)
    with pytest.raises(UsageError, match="'xlsx' is no format"):
        export_store(Store(store), "xlsx")
    with pytest.raises(UsageError, match="no store there"):
        export_store(Store(tmp_path / "nowhere"), "csv")
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("file", ["fronts/complex-1.parquet", "evaluations/nsga2-1/part-000000000.parquet"])
def test_a_damaged_store_ends_with_4_and_leaves_nothing(store, file):
    content = bytearray((store / file).read_bytes())
    content[len(content) // 2] ^= 1
    (store / file).write_bytes(content)
    with pytest.raises(DamagedFileError, match="damaged") as caught:
        export_store(Store(store), "csv")
    assert caught.value.exit_code == 4
    assert [path.name for path in store.parent.iterdir()] == ["toy"]


def test_a_disk_that_refuses_ends_with_74_and_leaves_nothing(store, monkeypatch):
    forced, fsync = [], os.fsync

    def failing(descriptor):
        forced.append(descriptor)
        if len(forced) == 3:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        fsync(descriptor)

    monkeypatch.setattr(os, "fsync", failing)
    with pytest.raises(DiskError, match="No space left on device") as caught:
        export_store(Store(store), "csv")
    assert caught.value.exit_code == 74
    assert [path.name for path in store.parent.iterdir()] == ["toy"]
    assert export_store(Store(store), "csv").evaluations == 136  # and there is room again


def test_a_full_disk_amid_a_table_is_said_too(store):
    path = os.pathsep.join([str(Path(__file__).parents[1]), *sys.path])
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, "export", str(store), "--format", "parquet"],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": path},
        check=False,
    )
    assert (done.returncode, "File too large" in done.stderr) == (74, True), done.stderr
    assert "Traceback" not in done.stderr
    assert [path.name for path in store.parent.iterdir()] == ["toy"]


def test_what_a_killed_export_left_is_cleared(store):
    left = store.with_name(".new-999999999-0123abcd-toy-csv")
    left.mkdir()
    (left / "evaluations.csv").write_text("half")
    other = store.with_name(".new-999999999-0123abcd-another")
    other.mkdir()
    export_store(Store(store), "csv")
    assert not left.exists()
    assert other.exists()


def test_fronts_may_be_empty_or_not_there_yet(tmp_path):
    with pytest.raises(NoFeasibleDesignError):
        make(tmp_path, CAMPAIGN.replace("min: 0 m", "min: 5 m"))
    store = Store(tmp_path / "toy")
    empty = export_store(store, "csv")
    assert set(empty.fronts.values()) == {0}
    text = (empty.folder / "fronts" / "combined.csv").read_text()
    assert text.count("\n") == 1
    assert text.startswith("design_id,run,x1,")
    shutil.rmtree(tmp_path / "toy" / "fronts")
    before = export_store(store, "parquet")
    assert (before.evaluations, before.fronts) == (136, {})
