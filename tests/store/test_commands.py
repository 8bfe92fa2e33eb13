"""What the commands make of a store that is damaged, of a later version, or in somebody's hands."""

import contextlib
import io
import json
import shutil

import pandas as pd
import pyarrow.parquet as pq
import pytest

from divideropt.cli import commands
from divideropt.errors import StoreError
from divideropt.store.tables import worded

CAMPAIGN = """
name: toy
model: {kind: "toy_model:CheckedToy"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2}}
constraints: {spare: {min: 0 m}}
strategies: {nsga2: {population: 12, generations: 4, seeds: [1, 2]}}
verification: {sample: 3}
optimality: {points: 3}
parallel: {workers: 1, backend: sequential}
"""

EVERY = ("status", "report", "verify", "run")


@pytest.fixture(scope="module", name="whole")
def _whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    (folder / "toy.yaml").write_text(CAMPAIGN)
    call("run", folder / "store")
    return folder


@pytest.fixture(name="store")
def _store(whole, tmp_path):
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    return tmp_path / "store"


def call(command, store):
    """Call a command of divideropt's on a store, and return what it said on both ways."""
    arguments = {
        "status": ["status", str(store), "--json"],
        "run": ["run", str(store.parent / "toy.yaml"), "--store", str(store)],
    }
    data, words = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(data), contextlib.redirect_stderr(words):
        commands.main(arguments.get(command, [command, str(store)]), standalone_mode=False)
    return data.getvalue(), words.getvalue()


def rewrite(path, metadata=None, **columns):
    """Write a table again as the store would, with another version or with other values in columns."""
    table = pq.read_table(path)
    for name, value in columns.items():
        place = table.schema.get_field_index(name)
        table = table.set_column(place, table.schema.field(name), [[value] * table.num_rows])
    path.write_bytes(worded(table.replace_schema_metadata(metadata or table.schema.metadata)))


@pytest.mark.parametrize("command", EVERY)
@pytest.mark.parametrize("file", ["fronts/combined", "evaluations/nsga2-2/part-000000000"])
def test_a_later_version_is_refused_by_number_by_every_command(store, file, command):
    path = store / f"{file}.parquet"
    rewrite(path, {b"divideropt.schema_version": b"99"})
    before = path.read_bytes()
    with pytest.raises(StoreError, match=rf"{path.name}: schema version 99, this program knows up to 2") as caught:
        call(command, store)
    assert caught.value.exit_code == 4
    assert path.read_bytes() == before


@pytest.mark.parametrize("command", ["report", "verify", "run"])
def test_so_is_a_later_version_of_what_was_verified(store, command):
    rewrite(store / "verification" / "part-000000000.parquet", {b"divideropt.schema_version": b"99"})
    with pytest.raises(StoreError, match=r"part-000000000\.parquet: schema version 99"):
        call(command, store)


def rows(path):
    """A front but for what verifying it adds."""
    front = pd.read_parquet(path)
    return front.drop(columns=["verified", *(name for name in front if name.startswith("deviation_"))])


@pytest.mark.parametrize("damage", ["bits", "verified", "gone"])
def test_a_damaged_front_is_made_again_from_the_logs(store, damage):
    path = store / "fronts" / "combined.parquet"
    before, expected = rows(path), json.loads(call("status", store)[0])
    if damage == "bits":
        path.write_bytes(path.read_bytes()[:-100])
    elif damage == "verified":
        rewrite(path, verified="perhaps")
    else:
        path.unlink()
    if damage != "gone":
        data, words = call("status", store)
        found = json.loads(data)
        assert "combined.parquet: damaged" in found.pop("damage")
        assert found == {key: value for key, value in expected.items() if key != "damage"}
        assert "combined.parquet: damaged" in words
        call("report", store)
        assert "combined.parquet is damaged: the front below" in (store / "report.html").read_text()
        assert "made again" in call("verify", store)[1]
        assert rows(path).equals(before)
        path.write_bytes(b"")
    call("run", store)
    assert rows(path).equals(before)


@pytest.mark.parametrize("command", EVERY)
@pytest.mark.parametrize("name", ["evaluations", "fronts", "verification", "endings", "optimality"])
def test_a_file_where_a_folder_should_be_is_refused_by_every_command(store, name, command):
    shutil.rmtree(store / name)
    (store / name).write_text("mine")
    if name in ("verification", "optimality") and command == "status":
        call(command, store)  # it has nothing to ask there
        return
    with pytest.raises(StoreError, match=rf"{name}: a file where the store has a folder; move it out of the store"):
        call(command, store)


@pytest.mark.parametrize("command", EVERY)
def test_a_campaign_that_was_changed_is_refused_by_every_command(store, command):
    path = store / "campaign.yaml"
    path.write_text(
        path.read_text().replace("x2: [0.0, 1.0]", "x2: [0.0, 2.0]").replace("population: 12", "population: 13")
    )
    with pytest.raises(StoreError, match=r"campaign\.yaml: damaged \(changed since it was written\)"):
        call(command, store)
