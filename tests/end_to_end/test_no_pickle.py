"""Nothing of a store is unpickled, whatever is put into it: a pickle runs what its writer likes."""

import os
import pickle
import sys

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from divideropt.cli import main

CAMPAIGN = """
name: toy
model: {kind: "toy_model:CheckedToy"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2}}
strategies: {nsga2: {population: 8, generations: GENERATIONS}}
parallel: {backend: sequential, workers: 1}
"""


class Bomb:
    """Makes a file when it is unpickled."""

    def __init__(self, trace):
        self.trace = trace

    def __reduce__(self):
        return os.mkdir, (str(self.trace),)


@pytest.fixture
def call(tmp_path, monkeypatch, capsys):
    """`call(*arguments)`: exit code and words of a command in this process."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["divideropt", *arguments])
        with pytest.raises(SystemExit) as left:
            main()
        return left.value.code, capsys.readouterr().err

    return run


@pytest.fixture
def store(tmp_path, call):
    (tmp_path / "toy.yaml").write_text(CAMPAIGN.replace("GENERATIONS", "3"))
    code, said = call("run", "toy.yaml")
    assert code == 0, said
    return tmp_path / "results" / "toy"


@pytest.fixture
def unpickled(monkeypatch):
    """What was unpickled since: calls of the module raise, and Python tells of each class that is looked up."""

    def refuse(*_args, **_kwargs):
        raise AssertionError("something was unpickled")

    for name in ("load", "loads", "Unpickler"):
        monkeypatch.setattr(pickle, name, refuse)
    _looked_up.clear()
    return _looked_up


_looked_up = []
sys.addaudithook(lambda event, arguments: _looked_up.append(arguments) if event == "pickle.find_class" else None)


def test_no_command_unpickles_what_is_in_a_store(tmp_path, store, call, unpickled):
    (tmp_path / "toy.yaml").write_text(CAMPAIGN.replace("GENERATIONS", "5"))
    for arguments in (
        ("status", str(store)),
        ("report", str(store)),
        ("verify", str(store), "--workers", "1"),
        ("run", "toy.yaml"),
        ("status", str(store), "--json"),
    ):
        code, said = call(*arguments)
        assert (code, "Traceback" in said) == (0, False), said
    assert unpickled == []
    with pytest.raises(AssertionError, match="unpickled"):
        pickle.loads(b"")


def test_pickles_in_the_metadata_of_a_table_are_no_more_than_bytes(tmp_path, store, call):
    """Arrow once unpickled the metadata of an extension type (CVE-2023-47248); pandas has metadata of its own."""
    bomb = pickle.dumps(Bomb(tmp_path / "trace"))
    extension = {
        b"ARROW:extension:name": b"arrow.py_extension_type",
        b"ARROW:extension:metadata": bomb,
        b"PANDAS_ATTRS": bomb,
    }
    paths = [*(store / "evaluations").rglob("*.parquet"), *(store / "fronts").rglob("*.parquet")]
    assert len(paths) >= 3
    for path in paths:
        table = pq.read_table(path)
        fields = [field.with_metadata({**(field.metadata or {}), **extension}) for field in table.schema]
        metadata = {**table.schema.metadata, b"pandas": b'{"columns": [], "index_columns": []}', b"joblib": bomb}
        pq.write_table(
            pa.Table.from_arrays(table.columns, schema=pa.schema(fields, metadata=metadata)),
            path,
            write_page_checksum=True,
        )
    for name in ("x.pkl", "x.joblib", "x.npy", "evaluations/nsga2-1/x.pkl", "fronts/x.pickle"):
        (store / name).write_bytes(bomb)
    for arguments in (
        ("status", str(store)),
        ("report", str(store)),
        ("verify", str(store), "--workers", "1"),
        ("run", "toy.yaml"),
    ):
        code, said = call(*arguments)
        assert code in (0, 4), said
        assert "Traceback" not in said
    assert len(pd.read_parquet(paths[0])) > 0
    assert not (tmp_path / "trace").exists()
    pickle.loads(bomb)
    assert (tmp_path / "trace").exists(), "the bomb is one"


@pytest.mark.parametrize("content", [b"\x80\x04.", b"PAR1", b"PAR1" + b"\0" * 100 + b"PAR1", b""])
def test_what_is_no_table_is_named_and_refused(store, call, content):
    path = next((store / "evaluations").rglob("*.parquet"))
    path.write_bytes(content)
    code, said = call("status", str(store))
    assert code == 4
    assert str(path) in said
    assert "Traceback" not in said


def test_an_overlarge_campaign_of_a_store_is_refused(store, call):
    with (store / "campaign.yaml").open("wb") as file:
        file.truncate(2**31)
    for command in ("status", "report", "verify"):
        code, said = call(command, str(store))
        assert code == 4
        assert "larger than 4 MiB" in said
