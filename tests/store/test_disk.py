"""Disks that refuse: exit code 74, what to do, what was logged intact; mended, the same command goes on."""

import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

TESTS = Path(__file__).parents[1]

CAMPAIGN = """
name: toy
model: {kind: "toy_model:CheckedToy"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2}}
constraints: {spare: {min: 0 m}}
strategies: {nsga2: {population: 100, generations: 12, seeds: [1, 2]}}
verification: {sample: 3}
parallel: {workers: 1, backend: sequential}
"""

FAILING_FSYNC = """
import errno, os
fsync = os.fsync
def failing(descriptor):
    name = os.readlink(f"/proc/self/fd/{descriptor}")
    if "nsga2-2" in name:
        os.write(1, (name + "\\n").encode())
        raise OSError(errno.EIO, os.strerror(errno.EIO))
    fsync(descriptor)
os.fsync = failing
from divideropt.cli import main
main()
"""
"""Every fsync of one run's files fails, and is told on standard output."""

VANISHING = """
import os, pathlib, sys
from divideropt.store import RunLog
append, count = RunLog.append, iter(range(100))
store = pathlib.Path(sys.argv[-1])
def vanishing(log, evaluations):
    append(log, evaluations)
    if next(count) == 15:
        store.rename(store.with_name("away"))
RunLog.append = vanishing
from divideropt.cli import main
main()
"""
"""The store is gone amid the second run."""


@pytest.fixture(scope="module", name="campaign")
def _campaign(tmp_path_factory):
    path = tmp_path_factory.mktemp("campaign") / "toy.yaml"
    path.write_text(CAMPAIGN)
    return path


@pytest.fixture(scope="module", name="whole")
def _whole(tmp_path_factory, campaign):
    store = tmp_path_factory.mktemp("whole") / "store"
    done = run(campaign, store)
    assert done.returncode == 0, done.stderr
    return store


@pytest.fixture(name="disk")
def _disk(tmp_path):
    """A disk of 128 KiB, and how to mount it otherwise."""
    folder = tmp_path / "disk"
    folder.mkdir()

    def mount(*options):
        return subprocess.run(["mount", "-t", "tmpfs", *options, "tmpfs", folder], capture_output=True, check=False)

    if os.geteuid() != 0 or shutil.which("mount") is None or mount("-o", "size=128k").returncode != 0:
        pytest.skip("no disk can be mounted here")
    yield folder, lambda options: subprocess.run(["mount", "-o", f"remount,{options}", folder], check=True)
    subprocess.run(["umount", folder], check=True)


def call(*arguments, python=("-m", "divideropt"), **options):
    paths = os.pathsep.join([str(TESTS), *filter(None, [os.environ.get("PYTHONPATH")])])
    command = [sys.executable, *python, *map(str, arguments)]
    environment = os.environ | {"PYTHONPATH": paths}
    heard = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True} | options
    return subprocess.run(command, env=environment, check=False, **heard)


def run(campaign, store, **options):
    return call("run", campaign, "--store", store, **options)


def tables(store):
    logs, fronts = sorted((store / "evaluations").iterdir()), sorted((store / "fronts").iterdir())
    return {path.name: pd.read_parquet(path) for path in (*logs, *fronts)}


def assert_refused(done, words):
    assert done.returncode == 74, done.stderr
    assert "Traceback" not in done.stderr
    assert words in done.stderr
    assert "make room or mend the folder, then run the same command again" in done.stderr


def assert_intact(store, whole):
    """What is logged is the beginning of what is logged in the end; nothing half is left."""
    logged = 0
    for log in sorted((store / "evaluations").glob("[!.]*")):
        found, expected = pd.read_parquet(log), pd.read_parquet(whole / "evaluations" / log.name)
        pd.testing.assert_frame_equal(found, expected[: len(found)], check_exact=True)
        logged += len(found)
    assert list(store.rglob(".new-*")) == []
    return logged


def assert_goes_on(campaign, store, whole):
    done = run(campaign, store)
    assert done.returncode == 0, done.stderr
    found, expected = tables(store), tables(whole)
    assert list(found) == list(expected)
    for name, table in expected.items():
        pd.testing.assert_frame_equal(found[name], table, check_exact=True)


def test_a_full_disk(campaign, whole, disk):
    folder, remount = disk
    assert_refused(run(campaign, folder / "store"), "No space left on device")
    assert assert_intact(folder / "store", whole) > 0
    status = call("status", folder / "store")
    assert status.returncode == 0, status.stderr
    remount("size=64m")
    assert_goes_on(campaign, folder / "store", whole)


def test_a_disk_that_becomes_read_only(campaign, whole, disk):
    folder, remount = disk
    remount("size=64m")
    shutil.copytree(whole, folder / "store")
    shutil.rmtree(folder / "store" / "evaluations" / "nsga2-2")
    remount("ro")
    assert_refused(run(campaign, folder / "store"), "Read-only file system")
    assert_refused(call("report", folder / "store"), "Read-only file system")
    assert_refused(run(campaign, folder / "other"), "Read-only file system")
    assert call("status", folder / "store").returncode == 0
    remount("rw")
    assert_goes_on(campaign, folder / "store", whole)


def test_a_limit_on_the_size_of_a_file(campaign, whole, tmp_path):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (15_000, resource.RLIM_INFINITY))

    assert_refused(run(campaign, tmp_path / "store", preexec_fn=limit), "File too large")
    assert_intact(tmp_path / "store", whole)
    assert_goes_on(campaign, tmp_path / "store", whole)


def test_an_fsync_that_fails_ends_the_run_and_is_not_tried_again(campaign, whole, tmp_path):
    done = run(campaign, tmp_path / "store", python=("-c", FAILING_FSYNC))
    assert_refused(done, "Input/output error")
    assert len(done.stdout.splitlines()) == 1
    assert assert_intact(tmp_path / "store", whole) == 1200
    assert not (tmp_path / "store" / "evaluations" / "nsga2-2").exists()
    assert_goes_on(campaign, tmp_path / "store", whole)


def test_a_folder_that_vanishes_and_comes_back(campaign, whole, tmp_path):
    done = run(campaign, tmp_path / "store", python=("-c", VANISHING))
    assert done.returncode == 74, done.stderr
    assert "store: the folder is gone. What was logged in it went with it: put it back, then run the" in done.stderr
    assert not (tmp_path / "store").exists()
    (tmp_path / "away").rename(tmp_path / "store")
    assert assert_intact(tmp_path / "store", whole) >= 1200
    assert_goes_on(campaign, tmp_path / "store", whole)


def test_words_that_nobody_can_hear_stop_nothing(campaign, whole, tmp_path):
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        assert run(campaign, tmp_path / "store", stderr=full).returncode == 0
    assert assert_intact(tmp_path / "store", whole) == 2400
