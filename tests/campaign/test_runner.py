"""A campaign from end to end on a model that costs nothing: resumed, extended, spread over workers."""

import io
import shutil
from pathlib import Path

import pandas as pd
import pytest

from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.errors import NoFeasibleDesignError, StoreError, UsageError
from divideropt.models.divider import Divider
from divideropt.store import RunLog, Store, TableSchema, fingerprint
from stores import assert_same, tables
from toy_model import toy_problem

TEXT = """
name: toy
model: {kind: "toy_model:Toy"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives:
  f1: {goal: 0.2}
  f2: {goal: 2, weight: 2}
constraints: {spare: {min: 0 m}}
reference_point: {f1: 1, f2: 20}
strategies:
  nsga2: {population: 12, generations: 5, seeds: [1, 2]}
  genetic: {population: 10, generations: 4}
  complex: {points: 6, evaluations: 60, seeds: [3]}
  goal_attainment: {directions: 5, evaluations: 150}
parallel: {workers: 2, backend: BACKEND}
"""


def run(folder: Path, text: str = TEXT, workers: int = 1, backend: str = "sequential", **options):
    words = io.StringIO()
    campaign = parse_campaign(text.replace("BACKEND", backend))
    return Runner(campaign, folder, workers, words).run(**options), words.getvalue()


@pytest.fixture(scope="module", name="whole")
def _whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "store"
    run(folder)
    return folder


def test_the_fronts_hold_the_feasible_non_dominated_designs(whole):
    found = tables(whole)
    assert list(found) == [
        "front combined", "front complex-3", "front genetic-1", "front goal_attainment-1", "front nsga2-1",
        "front nsga2-2", "log complex-3", "log genetic-1", "log goal_attainment-1", "log nsga2-1", "log nsga2-2",
    ]  # fmt: skip
    logs = pd.concat([table for name, table in found.items() if name.startswith("log")])
    good = logs[(logs.outcome == "ok") & (logs.spare >= 0)]
    points = list(zip(good.f1, good.f2.abs(), strict=True))
    best = {p for p in points if not any(q[0] <= p[0] and q[1] <= p[1] and q != p for q in points)}
    front = found["front combined"]
    assert set(zip(front.f1, front.f2.abs(), strict=True)) == best
    assert front.run.is_monotonic_increasing
    assert "batch" not in front.columns


def test_a_second_run_asks_the_model_nothing_and_changes_nothing(whole, tmp_path, monkeypatch):
    def forbidden(self, evaluations):
        raise AssertionError("something was simulated again")

    before = {p: p.stat().st_mtime_ns for p in (whole / "evaluations").rglob("*.parquet")}
    monkeypatch.setattr(RunLog, "append", forbidden)
    done, words = run(whole)
    assert done.nothing_new
    assert done.skipped == ("nsga2-1", "nsga2-2", "genetic-1", "complex-3", "goal_attainment-1")
    assert "from the log" in words
    assert before == {p: p.stat().st_mtime_ns for p in (whole / "evaluations").rglob("*.parquet")}


@pytest.mark.parametrize("kept", [0, 1, 2])
def test_a_store_that_lost_its_tail_is_completed_to_the_same_bits(whole, tmp_path, kept, monkeypatch):
    folder = tmp_path / "store"
    monkeypatch.setattr("divideropt.store.parts.FLUSH_ROWS", 1)
    run(folder)
    for log in (folder / "evaluations").iterdir():
        for part in sorted(log.iterdir())[kept:]:
            part.unlink()
    run(folder)
    assert_same(folder, whole)


def test_what_computes_otherwise_than_before_is_said_and_the_bits_decide(whole, tmp_path, monkeypatch):
    folder = tmp_path / "store"
    shutil.copytree(whole, folder)
    shutil.rmtree(folder / "evaluations" / "nsga2-2")
    before = fingerprint.fingerprint()
    monkeypatch.setattr(fingerprint, "fingerprint", lambda: before | {"numpy": "9.9", "processor": "abacus"})
    _, words = run(folder)
    (line,) = (line for line in words.splitlines() if "was written with" in line)
    assert f"numpy {before['numpy']} (now 9.9), processor {before['processor']} (now abacus); whether that" in line
    assert_same(folder, whole)
    assert "was written with" not in run(folder)[1]


def test_workers_do_not_change_a_bit(whole, tmp_path):
    run(tmp_path / "store", workers=2, backend="loky")
    assert_same(tmp_path / "store", whole)


def test_splitting_batches_does_not_change_a_bit(tmp_path):
    text = TEXT.replace("  genetic: {population: 10, generations: 4}\n", "").replace("seeds: [1, 2]", "seeds: [1]")
    text = text.replace("  complex: {points: 6, evaluations: 60, seeds: [3]}\n", "")
    text = text.replace("  goal_attainment: {directions: 5, evaluations: 150}\n", "")
    run(tmp_path / "split", text, workers=2, backend="loky")
    run(tmp_path / "alone", text)
    assert_same(tmp_path / "split", tmp_path / "alone")


DIVIDER = """
name: one
model: {kind: divider}
variables: {spool_radius: [6 mm, 16 mm], groove_width: [0.6 mm, 2 mm], total_pressure_drop: [2 MPa, 10 MPa]}
objectives:
  steady_state_error: {goal: 0.5 %}
  dynamic_error: {goal: 0.5 mL}
  source_pressure: {goal: 18 MPa}
constraints: {source_pressure: {max: 30 MPa}}
strategies: {nsga2: {population: 24, generations: 3, seeds: [1]}}
verification: {sample: 0}
parallel: {workers: 2, backend: BACKEND}
"""


def test_threads_share_the_batches_of_a_run_that_is_alone(tmp_path, monkeypatch):
    run(tmp_path / "alone", DIVIDER)
    used = []
    on_threads = Divider.on_threads
    monkeypatch.setattr(Divider, "on_threads", lambda self, n: used.append(n) or on_threads(self, n))
    monkeypatch.setattr("divideropt.campaign.attempts.simulate_share", None)  # no other process is asked
    run(tmp_path / "shared", DIVIDER, workers=2, backend="loky")
    assert used == [2]
    assert_same(tmp_path / "shared", tmp_path / "alone")


def test_larger_budgets_seeds_and_strategies_extend_a_store(whole, tmp_path):
    small = TEXT.replace("generations: 5, seeds: [1, 2]", "generations: 3, seeds: [1]")
    small = small.replace("evaluations: 60", "evaluations: 31").replace("evaluations: 150", "evaluations: 90")
    small = small.replace("  genetic: {population: 10, generations: 4}\n", "")
    run(tmp_path / "store", small)
    run(tmp_path / "store")
    assert_same(tmp_path / "store", whole)


def test_another_campaign_is_refused_with_the_differing_keys(whole):
    other = TEXT.replace("x2: [0, 1]", "x2: [0, 0.9]").replace("population: 12", "population: 8")
    other = other.replace("evaluations: 60", "evaluations: 50").replace("seeds: [1, 2]", "seeds: [1]")
    with pytest.raises(StoreError) as caught:
        run(whole, other)
    for key in ("variables.x2", "nsga2.population", "complex.evaluations: 60", "nsga2.seeds: [2]", "--fresh"):
        assert key in str(caught.value)


def test_another_order_of_variables_is_another_campaign_and_leaves_the_store_alone(whole):
    before = (whole / "campaign.yaml").read_bytes()
    with pytest.raises(StoreError, match="variables: in the order x1, x2, x3 in the store, x2, x1, x3"):
        run(whole, TEXT.replace("x1: [0, 1], x2: [0, 1]", "x2: [0, 1], x1: [0, 1]"))
    assert (whole / "campaign.yaml").read_bytes() == before


@pytest.mark.parametrize("content", [b"name: [", b"\xff\xfe", b"name: toy\n"])
def test_a_damaged_campaign_in_a_store_is_the_stores_fault(whole, tmp_path, content):
    folder = tmp_path / "store"
    run(folder)
    (folder / "campaign.yaml").write_bytes(content)
    with pytest.raises(StoreError, match=r"campaign\.yaml"):
        run(folder)


def test_logs_without_their_campaign_are_not_adopted(whole, tmp_path):
    folder = tmp_path / "store"
    run(folder)
    (folder / "campaign.yaml").unlink()
    with pytest.raises(StoreError, match="to say whose"):
        run(folder)
    assert not (folder / "campaign.yaml").exists()


def test_a_folder_that_is_no_store_is_not_moved(tmp_path):
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(UsageError, match="not a store"):
        run(tmp_path, fresh=True)
    assert (tmp_path / "thesis.txt").read_text() == "mine"
    assert [p.name for p in tmp_path.parent.glob("*.before-*")] == []


def test_a_log_that_was_not_asked_for_is_refused(whole, tmp_path):
    folder = tmp_path / "store"
    run(folder)
    first = folder / "evaluations" / "nsga2-1"
    schema = TableSchema.of(toy_problem())
    others = list(Store(folder).log("nsga2-2", schema).replay())
    shutil.rmtree(first)
    log = Store(folder).log("nsga2-1", schema)
    for batch in others:
        log.append(batch)
    log.flush()
    with pytest.raises(StoreError, match="batch 0 of the log is not the one the strategy asks for"):
        run(folder)


def test_fresh_moves_the_old_store_aside(tmp_path):
    folder = tmp_path / "store"
    run(folder)
    _, words = run(folder, fresh=True)
    aside = next(p for p in tmp_path.iterdir() if p != folder)
    assert str(aside) in words
    assert_same(aside, folder)


def test_a_campaign_without_a_feasible_design_says_so_and_keeps_its_log(tmp_path):
    with pytest.raises(NoFeasibleDesignError, match="no design is feasible"):
        run(tmp_path / "store", TEXT.replace("{min: 0 m}", "{min: 5 m}"))
    assert len(pd.read_parquet(tmp_path / "store" / "fronts" / "combined.parquet")) == 0
    assert len(pd.read_parquet(tmp_path / "store" / "evaluations" / "nsga2-1")) == 60
