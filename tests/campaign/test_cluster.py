"""A Dask cluster that is not there, or not fit, is refused in a sentence."""

import os
import socket
import sys
from contextlib import contextmanager

import pytest
from distributed import LocalCluster

from divideropt.campaign import cluster as ours
from divideropt.campaign.cluster import DaskCrew, abandoned, on_cluster
from divideropt.campaign.crew import ProcessDiedError
from divideropt.errors import UsageError

OPTIONS = {"dashboard_address": "127.0.0.1:0", "silence_logs": 50, "host": "127.0.0.1", "processes": True}


@pytest.fixture(scope="module", name="address")
def _address():
    with LocalCluster(n_workers=2, threads_per_worker=1, **OPTIONS) as cluster:
        yield cluster.scheduler_address


@pytest.fixture(name="crew")
def _crew(address, tmp_path):
    crew = DaskCrew(address, tmp_path)
    yield crew
    crew.close()


def test_it_has_as_many_calls_at_a_time_as_the_cluster_has_workers(crew, tmp_path):
    assert crew.size == 2
    assert [crew.submit(crew.call, abs, -i).result() for i in range(5)] == list(range(5))
    assert list(tmp_path.iterdir()) == []


def test_what_a_task_raises_is_raised_here(crew):
    with pytest.raises(ZeroDivisionError):
        crew.call(divmod, 1, 0)


def test_a_task_that_kills_worker_after_worker_is_given_up(crew):
    with pytest.raises(ProcessDiedError, match="worker after worker") as caught:
        crew.call(os._exit, 1)
    assert caught.value.final
    assert crew.call(abs, -1) == 1


def test_a_task_knows_where_it_is(crew):
    assert crew.call(on_cluster)
    assert not on_cluster()
    assert not abandoned()()


def test_a_worker_that_does_not_see_the_store_is_named(address, tmp_path, monkeypatch):
    @contextmanager
    def elsewhere(store):
        yield store / "nowhere", "word"

    monkeypatch.setattr(ours, "_written", elsewhere)
    with pytest.raises(UsageError, match=r"the worker tcp://127\.0\.0\.1:\d+ does not see the store .*share"):
        DaskCrew(address, tmp_path)


def test_a_worker_with_other_versions_is_named(address, tmp_path, monkeypatch):
    versions = ours._versions()
    monkeypatch.setattr(ours, "_versions", lambda: versions | {"numpy": "0.1"})
    with pytest.raises(UsageError, match=r"has numpy [\d.]+, here 0\.1"):
        DaskCrew(address, tmp_path)


def test_workers_of_several_threads_are_refused(tmp_path):
    with (
        LocalCluster(n_workers=1, threads_per_worker=2, **OPTIONS) as cluster,
        pytest.raises(UsageError, match="--nthreads 1"),
    ):
        DaskCrew(cluster.scheduler_address, tmp_path)


def test_a_scheduler_that_does_not_answer_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(ours, "CONNECT_SECONDS", 1.0)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(UsageError, match=f"tcp://127.0.0.1:{port}: no scheduler"):
        DaskCrew(f"tcp://127.0.0.1:{port}", tmp_path)


def test_without_dask_the_line_that_installs_it_is_said(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"pip install 'divideropt\[dask\]'"):
        DaskCrew("tcp://127.0.0.1:8786", tmp_path)
