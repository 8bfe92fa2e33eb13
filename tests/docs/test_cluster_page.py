"""The page on clusters, its commands followed to the letter on one machine, and what it says of each mishap.

The names of its machines, its port, its number of workers and its shared folder are replaced; nothing else is.
"""

import os
import re
import shlex
import signal
import socket
import subprocess
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from distributed import Client

from following import ROOT, here
from stores import assert_same

PAGE = ROOT / "docs" / "how-to" / "cluster.md"
PATIENCE = 90.0
"""How long anything is waited for [s]; a machine may have other things to do."""

ROUGH = """
name: rough
model: {kind: "rough_model:Rough", options: {begin: 2, pause: 0.05}}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2, weight: 2}}
constraints: {spare: {min: 0 m}}
strategies:
  nsga2: {population: 12, generations: 12, seeds: [1, 2]}
  complex: {points: 6, evaluations: 60, seeds: [3]}
"""
"""Three runs of some seven seconds for two workers: time to do something to them."""

pytestmark = pytest.mark.slow


class Followed:
    """Somebody follows the page in a folder, with a terminal for each of its commands."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.store = folder, folder / "shared" / "results" / "divider"
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.environment = here(folder / "commands")
        paths = [str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")]
        self.environment["PYTHONPATH"] = os.pathsep.join(filter(None, paths))  # the workers find the rough model
        text = PAGE.read_text(encoding="utf-8")
        shown = [self._on_this_machine(line) for line in re.findall(r"^    (.+)", text, re.MULTILINE)]
        (self._parallel,) = [line for line in shown if line.startswith("parallel:")]
        (self._scheduler,) = [line for line in shown if line.startswith("dask scheduler")]
        (self._worker,) = [line for line in shown if line.startswith("dask worker")]
        (self._run,) = [line for line in shown if line.startswith("divideropt run")]
        self.open: list[subprocess.Popen[str]] = []

    def _on_this_machine(self, line: str) -> str:
        for name, ours in (
            ("node1", "127.0.0.1"),
            ("8786", str(self.port)),
            ("--nworkers 16", "--nworkers 2"),
            ("/shared/", "shared/"),
        ):
            line = line.replace(name, ours)
        return line

    def begin(self) -> None:
        """Start scheduler and workers, and wait until both workers are there."""
        self.scheduler = self._terminal(self._scheduler)
        self.begin_workers()
        wait(lambda: len(self.ask(lambda client: client.nthreads())) == 2)

    def begin_workers(self) -> None:
        self.workers = self._terminal(self._worker)

    def ask(self, question):
        with Client(f"tcp://127.0.0.1:{self.port}", timeout=PATIENCE, set_as_default=False) as client:
            return question(client)

    def run(self, campaign: str, on_cluster: bool = True) -> "subprocess.Popen[str]":
        text = campaign + (self._parallel + "\n") * on_cluster
        (self.folder / "campaign.yaml").write_text(text, encoding="utf-8")
        return self._terminal(self._run)

    def alone(self, campaign: str) -> Path:
        """Run a campaign in the way of one machine; return its store."""
        (self.folder / "alone.yaml").write_text(campaign, encoding="utf-8")
        ended(self._terminal("divideropt run alone.yaml --store alone"), 0)
        return self.folder / "alone"

    def logged(self) -> None:
        """Wait until the first evaluations are on disk."""
        wait(lambda: any(self.store.glob("evaluations/*/*.parquet")))

    def close(self) -> None:
        for process in self.open:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.communicate(timeout=PATIENCE)

    def _terminal(self, command: str) -> "subprocess.Popen[str]":
        started = subprocess.Popen(
            shlex.split(command),
            cwd=self.folder,
            env=self.environment,
            executable=self.folder / "commands" / command.split(maxsplit=1)[0],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE if command.startswith("divideropt") else subprocess.DEVNULL,
            text=True,
            start_new_session=True,
        )
        self.open.append(started)
        return started


def wait(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.05)


def ended(process: "subprocess.Popen[str]", code: int) -> str:
    words = process.communicate(timeout=2 * PATIENCE)[1]
    assert process.returncode == code, words
    return words


@pytest.fixture(name="page")
def _page(tmp_path):
    followed = Followed(tmp_path)
    try:
        followed.begin()
        yield followed
    finally:
        followed.close()


def test_the_fronts_are_those_of_one_machine(page):
    campaign = (ROOT / "campaigns" / "quickstart.yaml").read_text(encoding="utf-8")
    campaign = re.sub(r"^parallel:.*\n", "", campaign, flags=re.MULTILINE)
    ended(page.run(campaign), 0)
    alone = page.alone(campaign)
    assert_same(page.store, alone)
    for kind in ("fronts", "endings"):
        files = sorted(path.name for path in (alone / kind).iterdir())
        assert files == sorted(path.name for path in (page.store / kind).iterdir())
        for name in files:
            assert (alone / kind / name).read_bytes() == (page.store / kind / name).read_bytes(), name


def test_a_worker_may_die_but_a_run_that_loses_four_is_given_up_and_goes_on_when_asked_again(page):
    running = page.run(ROUGH)
    page.logged()
    page.ask(four_deaths)
    words = ended(running, 6)
    assert "worker after worker died of it" in words
    assert "divideropt run campaign.yaml --store shared/results/divider" in words
    ended(page.run(ROUGH), 0)
    assert_same(page.store, page.alone(ROUGH))


def four_deaths(client: Client) -> None:
    """Kill the worker of one run, and each to which the run is given then."""
    key = next(key for keys in client.processing().values() for key in keys)
    killed: set[str] = set()
    while len(killed) < 4:
        wait(lambda: any(key in keys and name not in killed for name, keys in client.processing().items()))
        place = next(name for name, keys in client.processing().items() if key in keys)
        os.kill(client.run(os.getpid, workers=[place])[place], signal.SIGKILL)
        killed.add(place)


def test_where_all_workers_are_lost_the_command_waits_for_others(page):
    running = page.run(ROUGH)
    page.logged()
    os.killpg(page.workers.pid, signal.SIGKILL)
    wait(lambda: not page.ask(lambda client: client.nthreads()))
    page.begin_workers()
    ended(running, 0)
    assert_same(page.store, page.alone(ROUGH))


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGKILL, -signal.SIGKILL)])
def test_a_command_that_is_stopped_lets_the_workers_go_and_goes_on(page, number, code):
    running = page.run(ROUGH)
    page.logged()
    os.killpg(running.pid, number)
    ended(running, code)
    wait(lambda: not any(page.ask(lambda client: client.processing()).values()))
    ended(page.run(ROUGH), 0)
    assert_same(page.store, page.alone(ROUGH))


def test_a_scheduler_that_is_lost_takes_its_workers_along_and_the_store_goes_on_with_another(page):
    running = page.run(ROUGH)
    page.logged()
    page.scheduler.kill()
    words = ended(running, 6)
    assert "the scheduler was lost" in words
    page.workers.wait(timeout=PATIENCE)
    assert "no scheduler with a worker answers" in ended(page.run(ROUGH), 2)
    page.begin()
    ended(page.run(ROUGH), 0)
    assert_same(page.store, page.alone(ROUGH))


def test_a_store_begun_on_one_goes_on_on_the_other(page):
    running = page.run(ROUGH)
    page.logged()
    running.send_signal(signal.SIGINT)
    ended(running, 130)
    ended(page.run(ROUGH, on_cluster=False), 0)
    assert_same(page.store, page.alone(ROUGH))
