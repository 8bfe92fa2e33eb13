"""Front points simulated again, on a model that costs nothing: marked, kept, resumed, spread over workers."""

import io
import signal
from pathlib import Path

import pandas as pd
import pytest

from divideropt.campaign.interrupt import InterruptedRunError, WorkerLostError
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.campaign.status import read_status
from divideropt.campaign.verify import verify_store
from divideropt.errors import NoFeasibleDesignError, StoreError, StoreInUseError, UsageError
from divideropt.store import Store
from toy_model import ExactToy

TEXT = """
name: toy
model: {kind: "toy_model:CheckedToy", options: {OPTIONS}}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives:
  f1: {goal: 0.2}
  f2: {goal: 2, weight: 2}
constraints: {spare: {min: 0 m}}
strategies:
  nsga2: {population: 20, generations: 6, seeds: [1, 2]}
  genetic: {population: 10, generations: 4}
verification: {sample: 3, tolerance: 1 %}
parallel: {workers: 2, backend: BACKEND}
"""

SLIPPING = "error: 1.0e-4, slip: 0.05"
"""f2 is off by 0.01 %, and by 5 % where x1 is above 0.5: of the goals of 1 %."""


def run(folder: Path, options: str = SLIPPING, text: str = TEXT, backend: str = "sequential", workers: int = 1):
    words = io.StringIO()
    campaign = parse_campaign(text.replace("OPTIONS", options).replace("BACKEND", backend))
    return Runner(campaign, folder, workers, words, "the line that goes on").run().front, words.getvalue()


def verify(folder: Path, workers: int | None = None):
    words = io.StringIO()
    return verify_store(Store(folder), workers, words, "the line that goes on"), words.getvalue()


def fronts(folder: Path) -> dict[str, pd.DataFrame]:
    return {p.stem: pd.read_parquet(p) for p in sorted((folder / "fronts").glob("*.parquet"))}


def kept(folder: Path) -> pd.DataFrame:
    return pd.read_parquet(folder / "verification")


def assert_same(first: Path, second: Path) -> None:
    one, other = fronts(first), fronts(second)
    assert list(one) == list(other)
    for name, front in one.items():
        pd.testing.assert_frame_equal(front, other[name], check_exact=True)


@pytest.fixture(name="calls")
def _calls(monkeypatch):
    """Counts the designs that the reference simulates in this process."""
    calls = []
    whole = ExactToy.evaluate

    def counted(self, designs):
        calls.extend(designs.tolist())
        return whole(self, designs)

    monkeypatch.setattr(ExactToy, "evaluate", counted)
    return calls


def test_a_run_verifies_the_points_of_interest_and_says_which_deviate(tmp_path, calls):
    count, _ = run(tmp_path / "store")
    front = fronts(tmp_path / "store")["combined"]
    checked = front[front.verified != "no"]
    assert 0 < len(checked) == len(calls) == count.agree + count.deviate <= 4 + 5 + 3
    assert len(checked) < len(front) == count.points
    ends = front.loc[[front.f1.idxmin(), front.f1.idxmax(), front.f2.idxmin(), front.f2.idxmax()]]
    assert (ends.verified != "no").all()
    attainment = pd.concat([(front.f1 - 0.2) / 0.2, (front.f2.abs() - 2) / 2 * 2], axis=1).max(axis=1)
    assert (front.loc[attainment.nsmallest(5).index].verified != "no").all()
    slips = checked.x1 > 0.5
    assert slips.any()
    assert (checked[slips].verified == "deviates").all()
    assert (checked[~slips].verified == "yes").all()
    assert checked[slips].deviation_f2.values == pytest.approx(0.0501 / 1.0501)
    assert checked[~slips].deviation_f2.values == pytest.approx(1e-4 / 1.0001)
    assert (checked.deviation_f1 == 0.0).all()
    assert front[front.verified == "no"][["deviation_f1", "deviation_f2"]].isna().all(axis=None)
    assert count.largest == pytest.approx({"f1": 0.0, "f2": 0.0501 / 1.0501})


def test_a_runs_own_front_marks_the_same_points(tmp_path):
    run(tmp_path)
    found = fronts(tmp_path)
    combined = found.pop("combined").set_index("design_id").verified
    for front in found.values():
        own = front.set_index("design_id").verified
        shared = own.index.intersection(combined.index)
        assert (own[shared] == combined[shared]).all()
        assert (own[own.index.difference(combined.index)] == "no").all()


def test_another_outcome_deviates(tmp_path):
    run(tmp_path, "error: 0.0, failing_from: 0.5")
    front = fronts(tmp_path)["combined"]
    checked = front[front.verified != "no"]
    assert set(checked.verified) == {"yes", "deviates"}
    assert ((checked.x1 >= 0.5) == (checked.verified == "deviates")).all()
    results = kept(tmp_path).set_index("design_id")
    assert (results.loc[checked[checked.x1 >= 0.5].design_id].outcome == "unsettled").all()
    assert (results.outcome_text != "").any()


def test_verify_does_every_point_of_every_front_once(tmp_path, calls):
    run(tmp_path)
    before = len(calls)
    count, words = verify(tmp_path)
    found = fronts(tmp_path)
    points = pd.concat(found.values()).drop_duplicates("design_id")
    assert count.points == len(points) == len(calls) == count.agree + count.deviate
    assert f"verifying: {len(points) - before} of {len(points) - before} front points" in words
    for front in found.values():
        assert ((front.x1 > 0.5) == (front.verified == "deviates")).all()
        assert ((front.x1 <= 0.5) == (front.verified == "yes")).all()
    results = kept(tmp_path)
    assert results.design_id.is_unique
    assert set(results.design_id) == set(points.design_id)
    again, words = verify(tmp_path)
    assert again == count
    assert words == ""
    assert len(calls) == len(points)


@pytest.mark.parametrize("workers", [1, 2])
def test_workers_do_not_change_a_bit(tmp_path, workers):
    run(tmp_path / "one")
    verify(tmp_path / "one")
    run(tmp_path / "other", backend="loky", workers=workers)
    verify(tmp_path / "other", workers)
    assert_same(tmp_path / "one", tmp_path / "other")
    pd.testing.assert_frame_equal(kept(tmp_path / "one"), kept(tmp_path / "other"), check_exact=True)


def stop_after(count: int, monkeypatch):
    """Have a signal come while the reference simulates."""
    whole, seen = ExactToy.evaluate, []

    def interrupted(self, designs):
        seen.append(len(designs))
        if len(seen) == count:
            signal.raise_signal(signal.SIGTERM)
        return whole(self, designs)

    monkeypatch.setattr(ExactToy, "evaluate", interrupted)
    return seen


@pytest.mark.parametrize("at", [1, 2, 7])
def test_a_signal_keeps_what_was_found_and_the_next_call_goes_on(tmp_path, monkeypatch, at):
    run(tmp_path / "whole")
    verify(tmp_path / "whole")
    folder = tmp_path / "store"
    with monkeypatch.context() as patch:
        stop_after(at, patch)
        with pytest.raises(InterruptedRunError, match=r"SIGTERM(.|\n)*the line that goes on") as caught:
            run(folder)
    assert caught.value.exit_code == 143
    assert len(kept(folder)) == at
    assert (fronts(folder)["combined"].verified == "no").all()
    with monkeypatch.context() as patch:
        seen = stop_after(at, patch)
        with pytest.raises(InterruptedRunError):
            verify(folder)
        assert len(seen) == at
    assert len(kept(folder)) == 2 * at
    run(folder)
    verify(folder)
    assert_same(folder, tmp_path / "whole")
    assert kept(folder).design_id.is_unique


def test_a_lost_worker_is_said_and_the_next_call_goes_on(tmp_path):
    options = f"file: {(tmp_path / 'mended').as_posix()}"
    text = TEXT.replace("CheckedToy", "DeadlyReference")
    with pytest.raises(WorkerLostError, match=r"worker process was killed(.|\n)*the line that goes on"):
        run(tmp_path / "store", options, text, backend="loky", workers=2)
    assert (fronts(tmp_path / "store")["combined"].verified == "no").all()
    (tmp_path / "mended").touch()
    count, _ = run(tmp_path / "store", options, text)
    assert count.agree > 0


@pytest.mark.parametrize("left", [0, 1, 2])
def test_a_store_that_lost_its_tail_is_completed_to_the_same_bits(tmp_path, monkeypatch, left, calls):
    run(tmp_path / "whole")
    monkeypatch.setattr("divideropt.store.parts.FLUSH_ROWS", 1)
    run(tmp_path / "store")
    parts = sorted((tmp_path / "store" / "verification").iterdir())
    for part in parts[left:]:
        part.unlink()
    calls.clear()
    run(tmp_path / "store")
    assert len(calls) == len(parts) - left
    assert_same(tmp_path / "store", tmp_path / "whole")


def test_the_sample_and_the_tolerance_may_change_between_runs(tmp_path, calls):
    run(tmp_path)
    before, count = fronts(tmp_path)["combined"], len(calls)
    run(tmp_path, text=TEXT.replace("sample: 3, tolerance: 1 %", "sample: 3, tolerance: 6 %"))
    after = fronts(tmp_path)["combined"]
    assert len(calls) == count
    assert set(after[before.verified == "deviates"].verified) == {"yes"}
    run(tmp_path, text=TEXT.replace("sample: 3, tolerance: 1 %", "sample: 1000"))
    assert (fronts(tmp_path)["combined"].verified != "no").all()


def test_an_extended_store_verifies_what_is_new(tmp_path, calls):
    run(tmp_path / "store", text=TEXT.replace("generations: 6", "generations: 3"))
    run(tmp_path / "store")
    run(tmp_path / "whole")
    for folder in (tmp_path / "store", tmp_path / "whole"):
        verify(folder)
    assert_same(tmp_path / "store", tmp_path / "whole")
    assert kept(tmp_path / "store").design_id.is_unique


def test_a_model_without_a_reference_is_not_verified(tmp_path):
    text = TEXT.replace("CheckedToy", "Toy")
    count, words = run(tmp_path, "", text)
    assert "offers no reference()" in words
    assert (count.agree, count.deviate) == (0, 0)
    for front in fronts(tmp_path).values():
        assert (front.verified == "no").all()
        assert front.deviation_f2.isna().all()
    with pytest.raises(UsageError, match=r"offers no reference\(\)") as caught:
        verify(tmp_path)
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("model", "words"), [("BrokenReference", "RuntimeError: no licence"), ("OtherReference", "other parameters")]
)
def test_a_wrong_reference_is_refused_before_anything_runs(tmp_path, model, words):
    with pytest.raises(UsageError, match=words):
        run(tmp_path / "store", "", TEXT.replace("CheckedToy", model))
    assert not (tmp_path / "store").exists()


def test_results_of_other_designs_are_refused(tmp_path):
    run(tmp_path / "one")
    run(tmp_path / "other", text=TEXT.replace("x3: [0, 1]", "x3: [0, 0.5]"))
    for part in (tmp_path / "one" / "verification").iterdir():
        part.unlink()
    for part in (tmp_path / "other" / "verification").iterdir():
        part.rename(tmp_path / "one" / "verification" / part.name)
    for again in (run, verify):
        with pytest.raises(StoreError, match="another design than on the front"):
            again(tmp_path / "one")


def test_a_damaged_part_is_refused(tmp_path):
    run(tmp_path)
    part = next((tmp_path / "verification").iterdir())
    part.write_bytes(part.read_bytes()[:-9])
    for again in (run, verify):
        with pytest.raises(StoreError, match=r"part-000000000\.parquet: damaged.*delete .*verification"):
            again(tmp_path)
    part.unlink()
    run(tmp_path)


def test_verify_wants_a_store_with_fronts_to_itself(tmp_path):
    with pytest.raises(UsageError, match="no store there"):
        verify(tmp_path)
    run(tmp_path)
    with Store(tmp_path).writing(), pytest.raises(StoreInUseError):
        verify(tmp_path)
    (tmp_path / "fronts" / "combined.parquet").unlink()
    with pytest.raises(UsageError, match="no fronts yet"):
        verify(tmp_path)


def test_empty_fronts_have_nothing_to_verify(tmp_path):
    with pytest.raises(NoFeasibleDesignError):
        run(tmp_path, text=TEXT.replace("{min: 0 m}", "{min: 5 m}"))
    assert list(fronts(tmp_path)["combined"].verified) == []
    with pytest.raises(NoFeasibleDesignError, match="nothing to verify"):
        verify(tmp_path)


def test_the_status_counts_them(tmp_path):
    count, _ = run(tmp_path)
    found = read_status(Store(tmp_path))
    assert (found.front, found.verified, found.deviating) == (count.points, count.agree, count.deviate)
