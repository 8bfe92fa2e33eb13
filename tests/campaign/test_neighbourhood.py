"""KKT residuals of front points, on a model that costs nothing: computed, kept, resumed, spread over workers."""

import io
import signal
from pathlib import Path
from shutil import copytree

import numpy as np
import pandas as pd
import pytest

from divideropt.campaign.interrupt import InterruptedRunError
from divideropt.campaign.load import default_campaign, parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.campaign.status import read_status
from divideropt.campaign.verify import verify_store
from divideropt.errors import FileMistakes, StoreError
from divideropt.store import Store
from divideropt.store.parts import Parts
from stores import assert_same

TEXT = """
name: toy
model: {kind: "toy_model:CheckedToy"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives:
  f1: {goal: 0.2}
  f2: {goal: 2, weight: 2}
constraints: {spare: {min: 0 m}}
strategies:
  nsga2: {population: 20, generations: 6, seeds: [1, 2]}
verification: {sample: 0}
optimality: {points: 12}
parallel: {workers: 2, backend: BACKEND}
"""


def run(folder: Path, text: str = TEXT, backend: str = "sequential", workers: int = 1):
    words = io.StringIO()
    campaign = parse_campaign(text.replace("BACKEND", backend))
    return Runner(campaign, folder, workers, words, "the line that goes on").run()


def front(folder: Path, name: str = "combined") -> pd.DataFrame:
    return pd.read_parquet(folder / "fronts" / f"{name}.parquet")


def kept(folder: Path) -> pd.DataFrame:
    return pd.read_parquet(folder / "optimality")


@pytest.fixture(scope="module", name="whole")
def _whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("toy") / "store"
    run(folder)
    return folder


def test_the_points_asked_for_have_the_residual_that_the_formulas_give(whole):
    """The toy's objectives have gradients on paper; every front point is inside the box but for x2's failing side."""
    table = front(whole)
    computed = table[table.kkt == "computed"]
    assert 12 <= len(computed) <= 12 + 4 + 5 < len(table)
    assert (table.kkt_residual.notna() == (table.kkt == "computed")).all()
    extents = np.ptp(table.f1), np.ptp(table.f2.abs())
    checked = 0
    for row in computed.itertuples():
        if row.x1 < 0.11 or row.x2 < 0.06 or min(row.x3, 1 - row.x1, 1 - row.x2, 1 - row.x3) < 3e-3:
            continue  # a constraint, a bound or the failing side
        f2 = (1 + row.x2) * (1 + (row.x3 - 0.3) ** 2) / (0.1 + row.x1)
        first = np.array([1.0, 0.0, 0.0]) / extents[0]
        along = [-f2 / (0.1 + row.x1), f2 / (1 + row.x2), 2 * (row.x3 - 0.3) * (1 + row.x2) / (0.1 + row.x1)]
        second = np.array(along) / extents[1]
        share = np.clip(second @ (second - first) / ((second - first) @ (second - first)), 0.0, 1.0)
        assert row.kkt_residual == pytest.approx(np.linalg.norm(share * first + (1 - share) * second), rel=1e-6)
        checked += 1
    assert checked > 5


def test_the_fronts_of_the_runs_say_the_same_of_the_same_designs(whole):
    known = front(whole).set_index("design_id").kkt_residual
    for name in ("nsga2-1", "nsga2-2"):
        own = front(whole, name).set_index("design_id")
        shared = own.index.intersection(known.index)
        pd.testing.assert_series_equal(own.kkt_residual[shared], known[shared])
        assert (own.kkt[own.index.difference(known.index)] == "not_computed").all()


def test_what_was_simulated_is_kept_and_not_simulated_again(whole):
    before = kept(whole)
    points = (front(whole).kkt != "not_computed").sum()
    assert len(before) == points * 16  # four a variable, and four
    modified = [path.stat().st_mtime_ns for path in (whole / "optimality").iterdir()]
    run(whole)
    assert [path.stat().st_mtime_ns for path in (whole / "optimality").iterdir()] == modified


@pytest.mark.parametrize("backend", ["loky"])
def test_workers_change_no_byte(whole, tmp_path, backend):
    run(tmp_path / "store", backend=backend, workers=2)
    assert_same(tmp_path / "store", whole)
    pd.testing.assert_frame_equal(kept(tmp_path / "store"), kept(whole), check_exact=True)


@pytest.mark.parametrize("at", [1, 7])
def test_a_signal_stops_it_and_the_next_call_ends_with_the_same_bytes(whole, tmp_path, monkeypatch, at):
    folder = tmp_path / "store"
    with monkeypatch.context() as patch:
        append, seen = Parts.append, []

        def counted(self, table):
            append(self, table)
            if self._folder.name == "optimality":
                seen.append(table)
                if len(seen) == at:
                    signal.raise_signal(signal.SIGTERM)

        patch.setattr(Parts, "append", counted)
        with pytest.raises(InterruptedRunError, match="the line that goes on"):
            run(folder)
    assert len(kept(folder)) == at * 16
    assert (front(folder).kkt == "not_computed").all()
    run(folder)
    assert_same(folder, whole)


def test_a_store_that_lost_its_tail_is_completed_to_the_same_bytes(whole, tmp_path, monkeypatch):
    monkeypatch.setattr("divideropt.store.parts.FLUSH_ROWS", 1)
    run(tmp_path)
    parts = sorted((tmp_path / "optimality").iterdir())
    for part in parts[3:]:
        part.unlink()
    (tmp_path / "fronts" / "combined.parquet").unlink()
    run(tmp_path)
    assert_same(tmp_path, whole)


def test_an_extended_store_says_what_one_says_that_was_made_in_one_go(whole, tmp_path):
    run(tmp_path, TEXT.replace("generations: 6", "generations: 3"))
    run(tmp_path)
    same = ["kkt", "kkt_residual", "kkt_floor"]  # what was verified before the extension stays so
    for name in ("combined", "nsga2-1", "nsga2-2"):
        pd.testing.assert_frame_equal(front(tmp_path, name)[same], front(whole, name)[same], check_exact=True)
    run(tmp_path, TEXT.replace("points: 12", "points: 2"))
    fewer = front(tmp_path)
    assert 2 <= (fewer.kkt == "computed").sum() <= 2 + 4 + 5
    run(tmp_path, TEXT.replace("points: 12", "points: 0"))
    assert (front(tmp_path).kkt == "not_computed").all()


def test_verifying_keeps_the_residuals_also_of_a_damaged_front(whole, tmp_path):
    tmp_path = copytree(whole, tmp_path / "store")
    verify_store(Store(tmp_path), None, io.StringIO(), "")
    expected = front(whole).kkt_residual
    pd.testing.assert_series_equal(front(tmp_path).kkt_residual, expected)
    path = tmp_path / "fronts" / "combined.parquet"
    path.write_bytes(path.read_bytes()[:-20])
    assert read_status(Store(tmp_path)).kkt.median == pytest.approx(expected.median(), rel=1e-15)
    verify_store(Store(tmp_path), None, io.StringIO(), "")
    pd.testing.assert_series_equal(front(tmp_path).kkt_residual, expected)


def test_other_designs_than_the_neighbours_are_refused(whole, tmp_path):
    copytree(whole, tmp_path / "one")
    run(tmp_path / "other", TEXT.replace("x3: [0, 1]", "x3: [0, 0.5]"))
    for part in (tmp_path / "one" / "optimality").iterdir():
        part.unlink()
    for part in (tmp_path / "other" / "optimality").iterdir():
        part.rename(tmp_path / "one" / "optimality" / part.name)
    with pytest.raises(StoreError, match=r"other designs than its neighbours; delete the folder `optimality`"):
        run(tmp_path / "one")


def test_a_damaged_part_is_refused_before_anything_is_simulated(whole, tmp_path):
    tmp_path = copytree(whole, tmp_path / "store")
    part = min((tmp_path / "optimality").iterdir())
    part.write_bytes(part.read_bytes()[:-9])
    with pytest.raises(StoreError, match=r"part-000000000\.parquet: damaged.*delete .*optimality"):
        run(tmp_path, TEXT.replace("generations: 6", "generations: 7"))


def test_the_status_sums_them_up(whole):
    found = read_status(Store(whole)).kkt
    table = front(whole)
    assert found.computed == (table.kkt == "computed").sum()
    assert found.median == pytest.approx(table.kkt_residual.median())
    assert found.high == pytest.approx(table.kkt_residual.quantile(0.95))


def test_only_the_compiled_valve_is_explored_unasked():
    assert default_campaign().optimality.points == 200
    unasked = TEXT.replace("optimality: {points: 12}\n", "").replace("BACKEND", "sequential")
    assert parse_campaign(unasked).optimality.points == 0
    with pytest.raises(FileMistakes, match="-1 is too small; the least permitted is 0"):
        parse_campaign(TEXT.replace("points: 12", "points: -1").replace("BACKEND", "sequential"))
    with pytest.raises(FileMistakes, match="'points' is missing"):
        parse_campaign(TEXT.replace("{points: 12}", "{}").replace("BACKEND", "sequential"))
