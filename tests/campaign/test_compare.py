"""`divideropt compare`: on toy stores, against what their logs say, and what it refuses."""

import contextlib
import io
import json
import sys
from pathlib import Path

import moocore
import numpy as np
import pandas as pd
import pytest

from divideropt.analysis import INDICATORS
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.cli import main
from divideropt.errors import NoFeasibleDesignError

CAMPAIGN = """
name: toy
model: {kind: "toy_model:Toy"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.5}, f2: {goal: 2}}
constraints: {spare: {min: 0 m}}
reference_point: {f1: 1, f2: 8}
strategies:
  nsga2: {population: 12, generations: 10, seeds: [1, 2, 3, 4, 5]}
  complex: {evaluations: 80, seeds: [1, 2, 3, 4]}
  goal_attainment: {evaluations: 100, seeds: [1]}
verification: {sample: 0}
parallel: {workers: 1, backend: sequential}
"""


def run(text: str, folder: Path) -> Path:
    with contextlib.suppress(NoFeasibleDesignError):
        Runner(parse_campaign(text), folder, 1, io.StringIO()).run()
    return folder


@pytest.fixture(scope="module", name="home")
def _home(tmp_path_factory):
    """Stores `first`, of three strategies, and `second`, of one with other options."""
    home = tmp_path_factory.mktemp("compare")
    run(CAMPAIGN, home / "first")
    start, end = CAMPAIGN.index("strategies:"), CAMPAIGN.index("verification:")
    other = "strategies: {nsga2: {population: 20, generations: 6, seeds: [1, 2]}}\n"
    run(CAMPAIGN[:start] + other + CAMPAIGN[end:], home / "second")
    return home


@pytest.fixture(name="call")
def _call(home, monkeypatch, capsys):
    def call(*arguments):
        monkeypatch.chdir(home)
        monkeypatch.setattr(sys, "argv", ["divideropt", "compare", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        return left.value.code, *capsys.readouterr()

    return call


def log(store: Path, name: str, count: int) -> np.ndarray:
    """Objectives of the feasible among a run's first evaluations."""
    table = pd.read_parquet(store / "evaluations" / name).iloc[:count]
    table = table[(table.outcome == "ok") & (table.spare >= 0)]
    return np.column_stack([table.f1, table.f2.abs()])


def test_a_table_goes_to_standard_output_and_words_to_the_other(call):
    code, out, err = call("first")
    assert code == 0
    assert out.startswith("After 80 evaluations of each run: median (quartiles)\n")
    for words in ("nsga2", "complex", "goal_attainment", "hypervolume", "IGD+", "best max λ", "worst gap", "knee"):
        assert words in out
    assert "designs on the front of all" in out
    assert "of them meet every goal" in out
    assert err.splitlines() == [
        "compared after 80 evaluations of each run, as many as complex-1 has; the longest run has 120, "
        "--at N compares at another number",
        "no rank test where a strategy has one run: goal_attainment; give it more seeds",
    ]


def test_the_page_on_it_knows_every_figure():
    page = (Path(__file__).parents[2] / "docs" / "how-to" / "compare.md").read_text(encoding="utf-8")
    for indicator in INDICATORS.values():
        assert page.count(indicator.title) > 1


def test_json_says_what_the_logs_say(call, home):
    code, out, _ = call("first", "--json", "--at", "60")
    said = json.loads(out)
    assert (code, said["evaluations"]) == (0, 60)
    assert [(s["strategy"], s["runs"]) for s in said["strategies"]] == [
        ("nsga2", 5),
        ("complex", 4),
        ("goal_attainment", 1),
    ]
    fronts = {row["run"]: log(home / "first", row["run"], 60) for row in said["runs"]}
    for row in said["runs"]:
        box = moocore.hypervolume(fronts[row["run"]], ref=[1.0, 8.0]) / 8.0
        assert row["hypervolume"] == pytest.approx(box, rel=1e-12)
        F = fronts[row["run"]]
        assert row["attainment"] == pytest.approx(np.maximum((F[:, 0] - 0.5) / 0.5, (F[:, 1] - 2) / 2).min())
    together = np.unique(np.concatenate(list(fronts.values())), axis=0)
    assert sum(s["shared"] for s in said["strategies"]) == moocore.is_nondominated(together).sum()
    volumes = [row["hypervolume"] for row in said["runs"][:5]]
    assert said["strategies"][0]["hypervolume"]["median"] == sorted(volumes)[2]
    assert said["strategies"][2]["surfaces"] is None
    assert said["strategies"][0]["surfaces"]["worst"] <= min(volumes)
    test = next(t for t in said["tests"] if t["indicator"] == "hypervolume")
    pairs = [a > b for a in volumes for b in (row["hypervolume"] for row in said["runs"][5:9])]
    assert test["better"] == pytest.approx(np.mean(pairs))
    assert [t["p"] for t in said["tests"] if "goal_attainment" in (t["first"], t["second"])] == [None] * 12


def test_the_designs_to_choose_are_of_the_combined_front(call, home):
    said = json.loads(call("first", "--json", "--at", "60")[1])["front"]
    front = pd.read_parquet(home / "first" / "fronts" / "combined.parquet").set_index("design_id")
    assert said["designs"] == len(front)
    meeting = front[(front.f1 <= 0.5) & (front.f2.abs() <= 2.0)]
    assert sorted(d["design_id"] for d in said["meeting_goals"]) == sorted(meeting.index)
    for design in [*said["knees"], said["best_by_achievement"], said["nearest_goals"]]:
        row = front.loc[design["design_id"]]
        assert design["objectives"] == {"f1": row.f1, "f2": abs(row.f2)}
        assert design["variables"] == {"x1": row.x1, "x2": row.x2, "x3": row.x3}
        assert sum(design["pseudo_weights"].values()) == pytest.approx(1.0)
    assert said["nearest_goals"]["lacks"] == {"f1": 0.0, "f2": 0.0}


@pytest.mark.parametrize(("name", "read"), [("runs.csv", pd.read_csv), ("runs.parquet", pd.read_parquet)])
def test_out_has_a_row_a_run(call, tmp_path, name, read):
    assert call("first", "second", "--out", tmp_path / name)[0] == 0
    table = read(tmp_path / name)
    assert table.run.tolist() == [
        *(f"nsga2-{i}" for i in range(1, 6)),
        *(f"complex-{i}" for i in range(1, 5)),
        "goal_attainment-1",
        "nsga2-1",
        "nsga2-2",
    ]
    assert table.store.tolist() == ["first"] * 10 + ["second"] * 2
    assert (table.evaluations == 80).all()
    assert np.isfinite(table[["hypervolume", "igd_plus", "epsilon", "attainment", "mean_gap", "worst_gap"]]).all(
        axis=None
    )


def test_stores_are_told_apart_and_too_few_seeds_are_said(call):
    code, out, err = call("first", "second")
    assert code == 0
    assert "nsga2 in first" in out
    assert "nsga2 in second" in out
    assert "2 against 4 runs give no p below 0.13, however far apart; give more seeds" in err
    assert "4 against 5" not in err
    assert "as many as complex-1 in first has" in err


def test_runs_that_are_shorter_are_left_out_and_one_strategy_is_not_tested(call):
    code, out, err = call("first", "--at", "110")
    assert code == 0
    assert (
        "runs left out, having fewer evaluations: 4 of complex (at most 80), 1 of goal_attainment (at most 100)"
        in err
    )
    assert "one strategy only" in err
    assert "Rank tests" not in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "Missing argument"),
        (["nowhere"], "nowhere: no store there"),
        (["first", "nowhere"], "nowhere: no store there"),
        (["first", "first"], "named twice"),
        (["first", "--at", "121"], "no run has so many evaluations; the longest has 120"),
        (["first", "--at", "0"], "range"),
        (["first", "--out", "x.html"], "must end in .csv or .parquet"),
        (["first", "--out", "first/x.csv"], "inside the store"),
    ],
)
def test_a_wrong_call_ends_with_2(call, arguments, words):
    code, out, err = call(*arguments)
    assert (code, out) == (2, "")
    assert words in err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("x3: [0, 1]", "x3: [0, 0.5]", "variables.x3: [0.0, 1.0] in first, [0.0, 0.5] in other"),
        (
            "f1: {goal: 0.5}, f2: {goal: 2}",
            "f2: {goal: 2}, f1: {goal: 0.5}",
            "objectives: in the order f1, f2 in first",
        ),
        ("f1: {goal: 0.5}, ", "", "objectives.f1: "),
        ("goal: 0.5", "goal: 0.3", "objectives.f1.goal: 0.5 in first, 0.3 in other"),
        ("min: 0 m", "min: 1 mm", "constraints.spare.min: 0.0 m in first, 0.001 m in other"),
        ("f2: 8", "f2: 9", "reference_point.f2: 8.0 in first, 9.0 in other"),
        (
            '"toy_model:Toy"',
            '"toy_model:CheckedToy"',
            "model.kind: toy_model:Toy in first, toy_model:CheckedToy in other",
        ),
    ],
)
def test_another_problem_is_refused_with_what_differs(call, home, tmp_path, monkeypatch, old, new, words):
    text = CAMPAIGN.replace("generations: 10, seeds: [1, 2, 3, 4, 5]", "generations: 1, seeds: [1]")
    text = text.replace("f1: 1, ", "") if new == "" else text
    monkeypatch.chdir(tmp_path)
    other = home / "other"
    run(text.replace(old, new), tmp_path / "other")
    other.unlink(missing_ok=True)
    other.symlink_to(tmp_path / "other")
    code, out, err = call("first", "other")
    assert (code, out) == (2, "")
    assert "other: not the problem of first" in err
    assert words in err


def test_no_feasible_design_ends_with_5(call, home):
    text = CAMPAIGN.replace("min: 0 m", "min: 5 m").replace("generations: 10", "generations: 1")
    run(text, home / "infeasible")
    code, out, err = call("infeasible")
    assert (code, out) == (5, "")
    assert "no design is feasible in any of these stores" in err


def test_a_store_without_evaluations_ends_with_2(call, home):
    (home / "empty").mkdir()
    (home / "empty" / "campaign.yaml").write_bytes((home / "first" / "campaign.yaml").read_bytes())
    code, _, err = call("empty")
    assert code == 2
    assert "nothing has been simulated" in err


def test_a_damaged_log_ends_with_4(call, home):
    part = next((home / "second" / "evaluations" / "nsga2-1").iterdir())
    whole = part.read_bytes()
    part.write_bytes(whole[:-50])
    code, out, err = call("second")
    part.write_bytes(whole)
    assert (code, out) == (4, "")
    assert part.name in err
