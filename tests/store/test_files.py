"""Publishing: nothing is there by halves, nothing is overwritten, and a failed fsync is not tried again."""

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from divideropt.errors import DiskError, StoreInUseError
from divideropt.store import files
from divideropt.store.files import check_links, clear_temporaries, publish, publish_folder, publish_once


def writing(text):
    return lambda path: path.write_text(text)


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def failing(code):
    """A call that the system answers with an error, and how often it was made."""
    calls = []

    def call(*arguments):
        calls.append(arguments)
        raise OSError(code, os.strerror(code))

    return call, calls


def test_what_is_published_once_is_never_replaced(tmp_path):
    publish_once(tmp_path / "part", writing("first"))
    with pytest.raises(StoreInUseError, match="part: there already, so another process writes to this store"):
        publish_once(tmp_path / "part", writing("second"))
    assert (tmp_path / "part").read_text() == "first"
    assert names(tmp_path) == ["part"]


def test_a_folder_appears_with_its_first_file_and_none_is_replaced(tmp_path):
    publish_folder(tmp_path / "a" / "b" / "part", writing("first"))
    assert (tmp_path / "a" / "b" / "part").read_text() == "first"
    with pytest.raises(StoreInUseError, match="there already"):
        publish_folder(tmp_path / "a" / "b" / "part", writing("second"))
    assert (tmp_path / "a" / "b" / "part").read_text() == "first"
    assert names(tmp_path / "a") == ["b"]


def test_a_file_whose_folder_is_gone_is_not_published_elsewhere(tmp_path):
    with pytest.raises(DiskError, match="No such file or directory"):
        publish_once(tmp_path / "gone" / "part", writing("x"))
    assert names(tmp_path) == []


@pytest.mark.parametrize("way", [publish, publish_once, publish_folder])
def test_after_a_failed_fsync_nothing_is_published_and_nothing_is_tried_again(tmp_path, monkeypatch, way):
    path = tmp_path / "run" / "part"
    if way is not publish_folder:
        path.parent.mkdir()
    fsync, calls = failing(errno.EIO)
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", fsync)
        with pytest.raises(DiskError, match="Input/output error"):
            way(path, writing("x"))
    assert len(calls) == 1
    assert not path.exists()
    assert [p for p in tmp_path.rglob("*") if p != path.parent] == []
    with pytest.raises(
        DiskError, match=r"Input/output error when a write was forced to disk \(fsync\), so this process writes"
    ):
        way(path, writing("x"))  # the disk is mended, but this process cannot know what it lost
    way(tmp_path / "other" / "part", writing("x")) if way is publish_folder else way(tmp_path / "part", writing("x"))
    again = f"from divideropt.store.files import {way.__name__} as way; from pathlib import Path; import sys; " + (
        "way(Path(sys.argv[1]), lambda p: p.write_text('x'))"
    )
    subprocess.run([sys.executable, "-c", again, str(path)], check=True)
    assert path.read_text() == "x"


def test_a_filesystem_without_links_is_refused_in_words(tmp_path, monkeypatch):
    link, _ = failing(errno.EPERM)
    monkeypatch.setattr(os, "link", link)
    for call in (lambda: check_links(tmp_path), lambda: publish_once(tmp_path / "part", writing("x"))):
        with pytest.raises(DiskError, match="this filesystem knows no hard links"):
            call()
    assert names(tmp_path) == []


def test_what_dead_writers_left_is_cleared_and_what_others_are_writing_is_not(tmp_path):
    child = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    (tmp_path / f".new-{child.pid}-0123-report.html").write_text("half")
    (tmp_path / ".new-x-report.html").write_text("half")
    (tmp_path / ".new-1234567-0123-nsga2-1").mkdir()  # beyond the largest number of a process, or a dead one's
    (tmp_path / ".new-1234567-0123-nsga2-1" / "part").write_text("half")
    (tmp_path / "report.html").write_text("whole")
    clear_temporaries(tmp_path)
    assert names(tmp_path) == [f".new-{child.pid}-0123-report.html", "report.html"]
    child.communicate(b"\n")
    clear_temporaries(tmp_path)
    assert names(tmp_path) == ["report.html"]


def test_each_folder_that_is_made_is_forced_to_disk_before_the_next(tmp_path, monkeypatch):
    forced = []
    fsync = os.fsync

    def spied(descriptor):
        forced.append(str(Path(f"/proc/self/fd/{descriptor}").readlink()))
        fsync(descriptor)

    monkeypatch.setattr(os, "fsync", spied)
    files.make_folder(tmp_path / "a" / "b")
    assert forced == [str(tmp_path), str(tmp_path / "a")]
