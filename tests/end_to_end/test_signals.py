"""Signals: the first ends a campaign in order within 5 s, whatever its model does; the second at once; the end of a
parent is the end of its workers."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest

TEXT = """
name: rough
model: {kind: "rough_model:Rough", options: {OPTIONS}DEADLINE}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2}}
strategies: {nsga2: {population: 12, generations: 400, seeds: SEEDS}}
parallel: {workers: 2, backend: BACKEND}
"""


def start(folder: Path, options: str, backend="loky", seeds="[1, 2]", deadline="") -> "subprocess.Popen[str]":
    text = TEXT.replace("OPTIONS", options).replace("BACKEND", backend).replace("SEEDS", seeds)
    (folder / "rough.yaml").write_text(text.replace("DEADLINE", deadline and f", deadline: {deadline}"))
    paths = [str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))}
    command = [sys.executable, "-m", "divideropt", "run", "rough.yaml"]
    return subprocess.Popen(
        command, cwd=folder, env=environment, stderr=subprocess.PIPE, text=True, start_new_session=True
    )


def wait_until(question, complaint):
    end = time.monotonic() + 60
    while time.monotonic() < end:
        if question():
            return
        time.sleep(0.02)
    raise AssertionError(complaint)


def alive(pids):
    """Those of the processes that still run."""
    found = []
    for pid in pids:
        try:
            if Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z":
                found.append(pid)
        except OSError:
            continue
    return found


def descendants(pid):
    """A process and all that come from it."""
    children = Path(f"/proc/{pid}/task").glob("*/children")
    try:
        found = [int(child) for path in children for child in path.read_text().split()]
    except OSError:
        return [pid]
    return [pid, *(each for child in found for each in descendants(child))]


@pytest.mark.parametrize(
    ("way", "backend", "seeds", "deadline"),
    [
        ("hang", "sequential", "[1]", ""),
        ("hang_compiled", "sequential", "[1]", "10 min"),
        ("hang", "loky", "[1]", "10 min"),
        ("hang_compiled", "loky", "[1, 2]", ""),
    ],
)
def test_the_first_signal_ends_a_campaign_whose_model_does_not_end(tmp_path, way, backend, seeds, deadline):
    """Each batch takes 60 ms, until one that has no end; what came before it is in the log after the signal."""
    process = start(
        tmp_path, f"way: {way}, begin: 0, end: 1, after: 40, pause: 0.005, once: once", backend, seeds, deadline
    )
    wait_until((tmp_path / "once").exists, "the model did not hang")
    time.sleep(0.5)
    processes = descendants(process.pid)
    asked = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    words = process.communicate(timeout=60)[1]
    assert time.monotonic() - asked < 5.0
    assert process.returncode == 130, words
    assert words.splitlines()[-1].strip() == "divideropt run rough.yaml"
    assert "Traceback" not in words
    wait_until(lambda: not alive(processes), "a process has outlived the command")
    if way == "hang" or deadline:  # a model that keeps the interpreter's lock keeps the flush from being done, too
        log = pd.read_parquet(tmp_path / "results" / "rough" / "evaluations" / "nsga2-1")
        assert len(log) % 12 == 0
        assert len(log) >= 36


def test_the_second_signal_leaves_at_once(tmp_path):
    process = start(tmp_path, "way: hang, end: 1, once: once")
    wait_until((tmp_path / "once").exists, "the model did not hang")
    os.kill(process.pid, signal.SIGTERM)
    wait_until((tmp_path / "results" / "rough" / ".running" / "stop").exists, "the signal was not heard")
    assert process.poll() is None
    asked = time.monotonic()
    os.kill(process.pid, signal.SIGTERM)
    assert process.wait(timeout=60) == 143
    assert time.monotonic() - asked < 1.0
    process.communicate()


@pytest.mark.parametrize(("seeds", "deadline"), [("[1]", "10 min"), ("[1, 2]", "")])
def test_workers_end_with_their_parent_and_leave_nothing_in_shared_memory(tmp_path, seeds, deadline):
    for send in (os.kill, os.killpg):
        process = start(tmp_path, "way: hang_compiled, end: 1, once: once", seeds=seeds, deadline=deadline)
        wait_until((tmp_path / "once").exists, "the model did not hang")
        processes = descendants(process.pid)
        assert len(processes) >= 2
        send(process.pid, signal.SIGKILL)
        process.wait()
        killed = time.monotonic()
        wait_until(lambda pids=processes: not alive(pids), "a worker has outlived its parent")
        assert time.monotonic() - killed < 5.0
        process.communicate()
        left = [
            p.name for p in Path("/dev/shm").iterdir() if {str(pid) for pid in processes} & set(p.name.split("-"))
        ]
        assert left == []
        assert not [p for p in Path("/dev/shm").glob("joblib_*") if f"_{process.pid}_" in p.name]
        (tmp_path / "once").unlink()


@pytest.mark.parametrize("moments", [7, pytest.param(20, marks=pytest.mark.slow)])
def test_a_signal_in_the_first_moments_shows_no_traceback_of_ours(tmp_path, moments):
    """Python's own beginnings, before a line of ours is run, are not ours to mend: they may show theirs."""
    ours = 0
    for i in range(moments):
        process = start(tmp_path, "pause: 0.01")
        time.sleep((i + 1) / moments)
        os.killpg(process.pid, signal.SIGINT)
        words = process.communicate(timeout=60)[1]
        if "Traceback" in words:
            assert f"{os.sep}divideropt{os.sep}" not in words, words
        else:
            assert process.returncode in {130, -signal.SIGINT}, words
            ours += process.returncode == 130
    assert ours >= moments // 4


@pytest.mark.parametrize("after", [0.0, 0.3, 0.6])
def test_workers_that_are_being_started_end_with_their_parent(tmp_path, after):
    process = start(tmp_path, "way: hang_compiled, end: 1")
    workers = []

    def some_worker():
        workers[:] = [pid for pid in descendants(process.pid) if b"popen_loky_posix" in command_of(pid)]
        return workers

    wait_until(some_worker, "no worker was started")
    time.sleep(after)
    processes = descendants(process.pid)
    process.kill()
    process.wait()
    wait_until(lambda: not alive(processes), "a worker has outlived its parent")
    process.communicate()


def command_of(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""
