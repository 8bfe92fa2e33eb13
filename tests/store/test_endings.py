"""How a run ended, as a store keeps it: whole, or refused with its name."""

import json

import numpy as np
import pytest

from divideropt.errors import DamagedFileError
from divideropt.store import EndingRecord, Store
from divideropt.store.endings import read_ending, write_ending

RECORD = EndingRecord("goals", "nsga2-1/4 reaches every goal", 6, {"budget": 100, "termination": {"goals": True}})


@pytest.fixture(name="store")
def _store(tmp_path):
    store = Store(tmp_path / "store")
    with store.writing():
        store.write_ending("nsga2-1", RECORD)
    return store


def path(store):
    return store.folder / "endings" / "nsga2-1.json"


def test_what_is_written_is_read(store):
    assert store.read_ending("nsga2-1") == RECORD
    assert store.read_ending("nsga2-2") is None
    assert json.loads(path(store).read_text())["text"] == RECORD.text


def test_the_same_again_touches_nothing_and_another_replaces_it(store):
    before = path(store).stat()
    store.write_ending("nsga2-1", RECORD)
    assert path(store).stat().st_ino == before.st_ino
    other = EndingRecord("budget", "spent", 100, {"budget": 100})
    store.write_ending("nsga2-1", other)
    assert store.read_ending("nsga2-1") == other
    assert [p.name for p in path(store).parent.iterdir()] == ["nsga2-1.json"]


def test_every_damage_is_refused_by_name_or_says_the_same(store):
    content, random, refused = path(store).read_bytes(), np.random.default_rng(1), 0
    damaged = [content[:n] for n in range(0, len(content) - 1, 7)]
    for bit in random.integers(0, 8 * len(content), 200):
        turned = bytearray(content)
        turned[bit // 8] ^= 1 << int(bit % 8)
        damaged.append(bytes(turned))
    damaged += [b"", b"[]", b"null", b"[" * 60_000, b'{"sha256": 1}', b" " * 70_000]
    for bytes_ in damaged:
        path(store).write_bytes(bytes_)
        try:
            assert store.read_ending("nsga2-1") == RECORD
        except DamagedFileError as error:
            assert "nsga2-1.json: damaged" in str(error)
            assert "run the campaign again" in str(error)
            refused += 1
    assert refused > 0.9 * len(damaged)


def test_a_folder_in_its_place_is_refused(store):
    path(store).unlink()
    path(store).mkdir()
    with pytest.raises(DamagedFileError, match=r"nsga2-1\.json"):
        store.read_ending("nsga2-1")


def test_two_runs_that_end_at_once_both_keep_why(tmp_path):
    """Another process publishes the first ending of all between this one's look at the folder and its own rename."""
    folder = tmp_path / "endings"

    def meanwhile():
        if not (folder / "genetic-1.json").exists():
            folder.mkdir(exist_ok=True)
            (folder / "genetic-1.json").write_text("theirs")

    write_ending(folder / "nsga2-1.json", RECORD, meanwhile)
    assert read_ending(folder / "nsga2-1.json") == RECORD
    assert (folder / "genetic-1.json").read_text() == "theirs"
