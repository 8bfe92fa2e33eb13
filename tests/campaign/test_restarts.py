"""A worker that is killed, hangs or breaks down costs its run time, and the others nothing."""

import io
import sys
from pathlib import Path

import pandas as pd
import pytest

from divideropt.campaign import attempts as doing
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.mishaps import RESTARTS
from divideropt.campaign.runner import Runner
from divideropt.campaign.status import read_status
from divideropt.cli import main
from divideropt.errors import FileMistakes
from divideropt.store import Store
from stores import assert_same, logs

ONE = """  nsga2: {population: 12, generations: 2, seeds: [SEEDS]}
"""
TEXT = """
name: rough
model: {kind: "rough_model:Rough", options: {OPTIONS}DEADLINE}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives:
  f1: {goal: 0.2}
  f2: {goal: 2, weight: 2}
constraints: {spare: {min: 0 m}}
reference_point: {f1: 1, f2: 20}
strategies:
  nsga2: {population: 12, generations: 5, seeds: [1, 2]}
  complex: {points: 6, evaluations: 60, seeds: [3]}
parallel: {workers: WORKERS, backend: BACKEND}
"""


def run(folder: Path, options: str, backend="loky", workers=2, deadline="", text=TEXT):
    words = io.StringIO()
    text = text.replace("OPTIONS", options).replace("DEADLINE", deadline and f", deadline: {deadline}")
    campaign = parse_campaign(text.replace("BACKEND", backend).replace("WORKERS", str(workers)))
    return Runner(campaign, folder, workers, words).run(), words.getvalue()


@pytest.fixture(scope="module", name="calm")
def _calm(tmp_path_factory):
    """A store of the same campaign in which nothing goes wrong."""
    folder = tmp_path_factory.mktemp("calm") / "store"
    run(folder, "begin: 2", backend="sequential")
    return folder


def test_a_worker_killed_once_costs_no_cell(calm, tmp_path):
    done, words = run(tmp_path / "store", f"once: {tmp_path / 'once'}")
    assert_same(tmp_path / "store", calm)
    assert words.count("killed by signal 9, SIGKILL; begun anew from its log, 1 of 3") == 1
    assert not done.failures
    assert all(item.repeatable and item.failure is None for item in read_status(Store(tmp_path / "store")).runs)


def test_a_design_that_kills_its_process_is_blamed_alone(calm, tmp_path):
    run(tmp_path / "store", "way: fault, begin: 0.82, end: 0.84")
    whole = pd.concat(logs(tmp_path / "store").values())
    bad = whole.x3.between(0.82, 0.84)
    assert bad.sum() >= 2
    assert (whole.outcome == "crashed").equals(bad)
    assert whole.outcome_text[bad].str.fullmatch("it killed its process, twice: signal 11, SIGSEGV").all()
    assert [len(table) for table in logs(tmp_path / "store").values()] == [len(t) for t in logs(calm).values()]
    marked = {item.run: not item.repeatable for item in read_status(Store(tmp_path / "store")).runs}
    assert marked == {name: "crashed" in set(table.outcome) for name, table in logs(tmp_path / "store").items()}


@pytest.mark.parametrize("way", ["raise", "leave"])
@pytest.mark.parametrize("backend", ["sequential", "loky"])
def test_a_design_that_breaks_down_is_blamed_alone(tmp_path, way, backend):
    _, words = run(tmp_path / "store", f"way: {way}", backend=backend)
    whole = pd.concat(logs(tmp_path / "store").values())
    assert (whole.outcome == "crashed").equals(whole.x3.between(0.9, 0.95))
    assert "begun anew" not in words


@pytest.mark.parametrize(
    ("way", "backend", "seeds"),
    [("hang_compiled", "sequential", "1"), ("hang", "loky", "1, 2"), ("hang", "loky", "1"), ("vanish", "loky", "1")],
)
def test_a_design_beyond_the_deadline_is_ended_and_blamed_alone(tmp_path, way, backend, seeds):
    text = "".join(TEXT.partition("strategies:\n")[:2]) + ONE.replace("SEEDS", seeds) + TEXT.splitlines()[-1]
    run(tmp_path / "store", f"way: {way}, begin: 0.85, end: 0.91", backend, deadline="2 s", text=text)
    whole = pd.concat(logs(tmp_path / "store").values())
    bad = whole.x3.between(0.85, 0.91)
    assert bad.any()
    assert (whole.outcome == ("crashed" if way == "vanish" else "timed_out")).equals(bad)
    words = "exit code 7" if way == "vanish" else "no result within the deadline of 2 s"
    assert whole.outcome_text[bad].str.contains(words).all()


def test_a_deadline_changes_no_cell_and_may_change_in_a_store(calm, tmp_path):
    run(tmp_path / "store", "begin: 2", deadline="1 min", text=TEXT.replace("generations: 5", "generations: 3"))
    run(tmp_path / "store", "begin: 2", deadline="2 min")
    assert_same(tmp_path / "store", calm)


def test_a_share_of_a_batch_that_kills_its_process_is_done_again_singly(tmp_path):
    text = "".join(TEXT.partition("strategies:\n")[:2]) + ONE.replace("SEEDS", "1") + TEXT.splitlines()[-1]
    run(tmp_path / "store", "way: kill, begin: 0.85, end: 0.91", text=text)
    whole = logs(tmp_path / "store")["nsga2-1"]
    assert (whole.outcome == "crashed").equals(whole.x3.between(0.85, 0.91))
    assert (whole.outcome == "crashed").any()


@pytest.mark.parametrize("backend", ["sequential", "loky"])
def test_a_run_that_breaks_down_again_and_again_is_given_up_and_the_others_go_on(
    calm, tmp_path, monkeypatch, backend
):
    attempts = []
    monkeypatch.setattr(doing, "work", breaking(doing.work, attempts))
    workers = 4 if backend == "loky" else 1  # more than runs: batches are shared, and the runs driven from here
    done, words = run(tmp_path / "store", "begin: 2", backend, workers)
    assert len(attempts) == RESTARTS + 1
    assert done.failures == {"nsga2-2": "it broke down (MemoryError: no room), 4 times"}
    assert "nsga2-2: given up" in words
    found, expected = logs(tmp_path / "store"), logs(calm)
    assert list(found) == ["complex-3", "nsga2-1"]
    for name, table in found.items():
        pd.testing.assert_frame_equal(table, expected[name], check_exact=True)
    assert (tmp_path / "store" / "fronts" / "combined.parquet").is_file()
    status = {item.run: item.failure for item in read_status(Store(tmp_path / "store")).runs}
    assert status == {"nsga2-1": None, "nsga2-2": done.failures["nsga2-2"], "complex-3": None}
    monkeypatch.undo()
    done, _ = run(tmp_path / "store", "begin: 2", backend, workers)
    assert not done.failures
    assert_same(tmp_path / "store", calm)


def test_the_command_says_which_runs_are_incomplete_and_ends_with_6(tmp_path, monkeypatch, capsys):
    text = TEXT.replace("OPTIONS", "begin: 2").replace("DEADLINE", "").replace("WORKERS", "1")
    (tmp_path / "rough.yaml").write_text(text.replace("BACKEND", "sequential"))
    monkeypatch.chdir(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(doing, "work", breaking(doing.work))
        code, _, words = called(["run", "rough.yaml"], monkeypatch, capsys)
    assert code == 6
    assert "1 of 3 runs are incomplete" in words
    assert "  nsga2-2: it broke down (MemoryError: no room), 4 times\n" in words
    assert words.splitlines()[-1] == "  divideropt run rough.yaml"
    assert "Traceback" not in words
    store = tmp_path / "results" / "rough"
    assert "Incomplete, given up: nsga2-2: it broke down" in (store / "report.html").read_text(encoding="utf-8")
    code, said, _ = called(["status", "results/rough"], monkeypatch, capsys)
    assert code == 0
    assert "nsga2-2: 0 of 60 evaluations" in said
    assert "\n  incomplete, given up: it broke down (MemoryError: no room), 4 times\n" in said
    assert called(["run", "rough.yaml"], monkeypatch, capsys)[0] == 0
    assert "incomplete" not in called(["status", "results/rough"], monkeypatch, capsys)[1]


def called(arguments, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["divideropt", *arguments])
    with pytest.raises(SystemExit) as left:
        main()
    return left.value.code, *capsys.readouterr()


def breaking(work, attempts=None):
    """Let the run nsga2-2 break down each time."""

    def broken(campaign, problem, folder, run, simulate=None):
        if run.name == "nsga2-2":
            if attempts is not None:
                attempts.append(run.name)
            raise MemoryError("no room")
        return work(campaign, problem, folder, run, simulate)

    return broken


def test_deadline_and_scheduler_come_back_from_a_stored_campaign():
    text = TEXT.replace("OPTIONS", "begin: 2").replace("DEADLINE", ", deadline: 2 min").replace("WORKERS", "2")
    campaign = parse_campaign(text.replace("BACKEND", 'dask, scheduler: "tcp://node1:8786"'))
    again = parse_campaign(dump_campaign(campaign))
    assert again == campaign
    assert (again.model.deadline, again.parallel.scheduler) == (120.0, "tcp://node1:8786")


@pytest.mark.parametrize("deadline", ["60", "0 s", "-1 s", "1 m"])
def test_a_deadline_is_a_time_above_0(deadline):
    text = TEXT.replace("OPTIONS", "begin: 2").replace("DEADLINE", f", deadline: {deadline}").replace("WORKERS", "2")
    with pytest.raises(FileMistakes, match=r"campaign:3:\d+: model\.deadline: "):
        parse_campaign(text.replace("BACKEND", "loky"))
