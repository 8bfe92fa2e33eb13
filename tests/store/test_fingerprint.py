"""What computed is kept with a store, and a difference is said in a line."""

import json

import pytest

from divideropt.store import Store, fingerprint


def kept(folder):
    return list(Store(folder).writers())


def test_the_same_machine_is_kept_once_and_says_nothing(tmp_path):
    for _ in range(2):
        with Store(tmp_path).writing():
            assert Store(tmp_path).keep_fingerprint() is None
    (only,) = kept(tmp_path)
    assert only.keys() == {
        "python", "divideropt", "numpy", "scipy", "numba", "pymoo", "moocore", "processor", "features"
    }  # fmt: skip
    assert all(only.values())


def test_another_version_and_another_processor_are_named(tmp_path, monkeypatch):
    store = Store(tmp_path)
    store.keep_fingerprint()
    first = fingerprint.fingerprint()
    features = first["features"].split()
    other = first | {"numpy": "9.9", "processor": "abacus", "features": " ".join(["beads", *features[1:]])}
    monkeypatch.setattr(fingerprint, "fingerprint", lambda: other)
    line = store.keep_fingerprint()
    assert line.startswith(f"this store was written with numpy {first['numpy']} (now 9.9), processor ")
    assert f"processor features lost: {features[0]}, processor features new: beads; " in line
    assert "\n" not in line
    assert kept(tmp_path) == [first, other]


@pytest.mark.parametrize("content", [b"", b"{", b"\xff", b"{}", b"[1]"])
def test_a_damaged_record_is_said_and_begun_anew(tmp_path, content):
    (tmp_path / ".writers.json").write_bytes(content)
    assert "damaged" in Store(tmp_path).keep_fingerprint()
    assert kept(tmp_path) == [fingerprint.fingerprint()]


def test_a_changed_record_is_believed_in_nothing(tmp_path):
    Store(tmp_path).keep_fingerprint()
    path = tmp_path / ".writers.json"
    whole = path.read_bytes()
    for place in range(0, len(whole), 7):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        assert kept(tmp_path) in ([], [fingerprint.fingerprint()])  # a bit of a blank changes nothing


def test_a_record_of_before_the_digest_is_read(tmp_path):
    (tmp_path / ".writers.json").write_text(json.dumps([{"python": "3.11.0"}]))
    assert kept(tmp_path) == [{"python": "3.11.0"}]
