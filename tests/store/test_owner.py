"""One writer: who holds a store is said, and who no longer holds it publishes nothing."""

import os
import pickle
import shutil
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

from divideropt.errors import DiskError, StoreError, StoreInUseError
from divideropt.store import Store, TableSchema
from divideropt.store.owner import Owner
from toy_model import toy_problem

PROBLEM = toy_problem()
SCHEMA = TableSchema.of(PROBLEM)

HOLD = """
import sys; from pathlib import Path; from divideropt.store import Store
with Store(Path(sys.argv[1])).writing():
    print("held", flush=True); input()
"""


def append(log, seed):
    log.append(PROBLEM.simulate(PROBLEM.space.sample(7, np.random.default_rng(seed))))
    log.flush()


def fronts_and_parts(folder):
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file() and p.suffix == ".parquet")


def test_a_second_writer_hears_who_holds_the_store(tmp_path):
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    holder.stdout.readline()
    with (
        pytest.raises(StoreInUseError, match=rf"writing to this store: process {holder.pid} on .*; wait") as caught,
        Store(tmp_path).writing(),
    ):
        pass
    assert caught.value.exit_code == 3
    holder.communicate("\n")
    with Store(tmp_path).writing():
        pass


def test_a_task_that_outlives_its_client_publishes_nothing(tmp_path):
    store = Store(tmp_path)
    with store.writing():
        task = pickle.loads(pickle.dumps(store))  # as a worker gets it
        log = task.log("nsga2-1", SCHEMA)
        append(log, 1)
        before = fronts_and_parts(tmp_path)
    with pytest.raises(StoreInUseError, match=r"held by nobody now, not by process \d+ on"):
        append(log, 2)
    with Store(tmp_path).writing():
        for write in (
            lambda: append(task.log("nsga2-2", SCHEMA), 3),
            lambda: task.write_front("nsga2-1", SCHEMA.front.empty_table()),
            lambda: task.write_campaign("name: other\n"),
        ):
            with pytest.raises(StoreInUseError, match=rf"held by process {os.getpid()} on .* now, not by") as caught:
                write()
        assert caught.value.exit_code == 3
    assert fronts_and_parts(tmp_path) == before
    assert not task.exists
    assert list(tmp_path.rglob(".new-*")) == []


def test_two_who_both_think_the_store_theirs_overwrite_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(Owner, "check", lambda *_: None)  # the older one looked just before the newer one came
    store = Store(tmp_path)
    with store.writing():
        older, newer = (pickle.loads(pickle.dumps(store)).log("nsga2-1", SCHEMA) for _ in range(2))
        append(older, 1)
        with pytest.raises(StoreInUseError, match="there already"):
            append(newer, 1)
        assert len(list(newer.replay())) == 1
        append(newer, 2)
        with pytest.raises(StoreInUseError, match=r"part-000000007.*: there already"):
            append(older, 3)
    table = pd.read_parquet(tmp_path / "evaluations" / "nsga2-1")
    assert table.batch.tolist() == [0] * 7 + [1] * 7
    assert list(tmp_path.rglob(".new-*")) == []


def test_a_store_whose_folder_is_gone_is_not_made_anew(tmp_path):
    store = Store(tmp_path / "store")
    with store.writing():
        log = store.log("nsga2-1", SCHEMA)
        append(log, 1)
        shutil.rmtree(store.folder)
        with pytest.raises(DiskError, match="the folder is gone"):
            append(log, 2)
    assert not store.folder.exists()


@pytest.mark.parametrize("name", ["evaluations", "evaluations/nsga2-1", "fronts", "verification", ".running"])
def test_a_file_where_a_folder_should_be_is_noticed_before_anything_is_simulated(tmp_path, name):
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("mine")
    with pytest.raises(StoreError, match=rf"{name}: a file where the store has a folder"), Store(tmp_path).writing():
        pass
    assert (tmp_path / name).read_text() == "mine"


def test_leftovers_of_a_dead_writer_are_cleared_by_the_next_and_not_by_readers(tmp_path):
    left = [
        tmp_path / folder / ".new-1234567-ab-x" for folder in ("", "evaluations", "evaluations/nsga2-1", "fronts")
    ]
    for path in left:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.mkdir()
        (path / "part-000000000.parquet").write_text("half")
    store = Store(tmp_path)
    assert not store.has_logs
    assert store.log("nsga2-1", SCHEMA).table().num_rows == 0
    assert store.read_front("combined", SCHEMA) is None
    assert all(path.exists() for path in left)
    with store.writing():
        assert not any(path.exists() for path in left)
