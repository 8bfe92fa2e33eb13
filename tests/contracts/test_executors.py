"""What every way of executing a campaign promises: the same bytes, and that no mishap of a process costs any."""

import io
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest
from distributed import Client, LocalCluster

from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.campaign.status import read_status
from divideropt.store import Store
from stores import assert_same, tables

TEXT = """
name: rough
model: {kind: "rough_model:Rough", options: {OPTIONS}DEADLINE}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2, weight: 2}}
constraints: {spare: {min: 0 m}}
strategies:
  nsga2: {population: 12, generations: GENERATIONS, seeds: SEEDS}
  complex: {points: 6, evaluations: 36, seeds: [3]}
parallel: PARALLEL
"""


@pytest.fixture(scope="module", name="cluster")
def _cluster():
    """A scheduler and two worker processes, on loopback."""
    options = {"dashboard_address": "127.0.0.1:0", "silence_logs": 50, "host": "127.0.0.1"}
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, **options) as cluster:
        yield cluster


@pytest.fixture(params=["sequential", "loky", "dask"], name="parallel")
def _parallel(request):
    if request.param == "dask":
        address = request.getfixturevalue("cluster").scheduler_address
        return f'{{backend: dask, scheduler: "{address}"}}'
    return f"{{workers: 2, backend: {request.param}}}"


def written(parallel, options="begin: 2", deadline="", seeds="[1, 2]", generations=3):
    text = TEXT.replace("OPTIONS", options).replace("DEADLINE", deadline and f", deadline: {deadline}")
    return text.replace("PARALLEL", parallel).replace("SEEDS", seeds).replace("GENERATIONS", str(generations))


def run(folder: Path, text: str):
    campaign, words = parse_campaign(text), io.StringIO()
    return Runner(campaign, folder, campaign.parallel.workers, words).run(), words.getvalue()


@pytest.fixture(scope="module", name="calm")
def _calm(tmp_path_factory):
    """The store of a campaign run by this process alone, in which nothing goes wrong."""
    folder = tmp_path_factory.mktemp("calm") / "store"
    run(folder, written("{backend: sequential}"))
    return folder


def test_one_seed_gives_the_same_fronts_and_bytes(parallel, calm, tmp_path):
    run(tmp_path / "store", written(parallel))
    assert_same(tmp_path / "store", calm)


def test_a_run_that_is_alone_gives_the_same_bytes(parallel, tmp_path):
    """Its batches are shared where there are workers."""
    for name, how in (("alone", "{backend: sequential}"), ("shared", parallel)):
        run(
            tmp_path / name,
            written(how, seeds="[5]").replace("  complex: {points: 6, evaluations: 36, seeds: [3]}\n", ""),
        )
    assert_same(tmp_path / "shared", tmp_path / "alone")


def test_a_store_goes_on_under_another_executor(parallel, calm, tmp_path):
    run(tmp_path / "store", written(parallel, generations=2))
    run(tmp_path / "store", written("{backend: sequential}"))
    assert_same(tmp_path / "store", calm)


def test_a_process_killed_once_costs_no_cell(parallel, calm, tmp_path):
    if "sequential" in parallel:
        pytest.skip("this process would be the one that is killed; see the next test")
    done, _ = run(tmp_path / "store", written(parallel, f"begin: 0.8, once: {tmp_path / 'once'}"))
    assert (tmp_path / "once").exists()
    assert not done.failures
    assert_same(tmp_path / "store", calm)


def test_a_sequential_campaign_that_was_killed_finds_the_design_that_did_it(tmp_path):
    """It takes a call for each run, since each may kill the only process there is."""
    text = written("{backend: sequential}", "way: kill, begin: 0.87, end: 0.9")
    codes = []
    while codes[-1:] != [0] and len(codes) < 4:
        process = command(tmp_path, text)
        process.communicate(timeout=60)
        codes.append(process.returncode)
    assert codes[0] == -signal.SIGKILL
    assert codes[-1] == 0
    assert_only_blamed(tmp_path / "results" / "rough", "crashed", 0.87, 0.9)


def test_a_raise_is_the_outcome_of_that_design(parallel, tmp_path):
    run(tmp_path / "store", written(parallel, "way: raise, begin: 0.8, end: 0.9"))
    assert_only_blamed(tmp_path / "store", "crashed", 0.8, 0.9)


def test_a_hang_is_ended_and_is_the_outcome_of_that_design(parallel, tmp_path):
    run(tmp_path / "store", written(parallel, "way: hang_compiled, begin: 0.87, end: 0.89", deadline="2 s"))
    assert_only_blamed(tmp_path / "store", "timed_out", 0.87, 0.89)
    marked = {item.run: not item.repeatable for item in read_status(Store(tmp_path / "store")).runs}
    assert marked == {
        name.removeprefix("log "): "timed_out" in set(table.outcome)
        for name, table in tables(tmp_path / "store").items()
        if name.startswith("log")
    }


def assert_only_blamed(folder: Path, outcome: str, begin: float, end: float) -> None:
    whole = pd.concat(table for name, table in tables(folder).items() if name.startswith("log"))
    bad = whole.x3.between(begin, end)
    assert bad.any()
    assert (whole.outcome == outcome).equals(bad)
    assert len(whole) == 12 * 3 * 2 + 36


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGKILL, -9)])
def test_a_campaign_that_is_stopped_goes_on_to_the_same_bytes(parallel, calm, tmp_path, number, code):
    """The model hangs once, in mid-run, when the signal comes; what is left elsewhere lets the store go."""
    text = written(parallel, f"way: hang, begin: 0.8, once: {tmp_path / 'once'}")
    process = command(tmp_path, text)
    end = time.monotonic() + 60
    while not (tmp_path / "once").exists() and time.monotonic() < end:
        time.sleep(0.05)
    asked = time.monotonic()
    os.killpg(process.pid, number)
    words = process.communicate(timeout=60)[1]
    assert process.returncode == code, words
    assert time.monotonic() - asked < 5.0
    if number == signal.SIGINT:
        assert words.splitlines()[-1].strip() == "divideropt run rough.yaml"
    process = command(tmp_path, text)
    words = process.communicate(timeout=100)[1]
    assert process.returncode == 0, words
    assert_same(tmp_path / "results" / "rough", calm)


def command(folder: Path, text: str) -> "subprocess.Popen[str]":
    (folder / "rough.yaml").write_text(text)
    paths = [str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
    return subprocess.Popen(
        [sys.executable, "-m", "divideropt", "run", "rough.yaml"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))},
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def test_a_dask_worker_killed_from_outside_costs_no_cell(cluster, calm, tmp_path):
    text = written(f'{{backend: dask, scheduler: "{cluster.scheduler_address}"}}', "begin: 2, pause: 0.02")
    process = command(tmp_path, text)
    running = tmp_path / "results" / "rough" / ".running"
    end = time.monotonic() + 60
    while not list(running.glob("*.begun")) and time.monotonic() < end:
        time.sleep(0.02)
    with Client(cluster, set_as_default=False) as client:
        os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)
    words = process.communicate(timeout=100)[1]
    assert process.returncode == 0, words
    assert_same(tmp_path / "results" / "rough", calm)
