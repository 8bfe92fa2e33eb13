"""The contest of optimisers, with our own players alone: the others' packages are not needed to test it."""

import ast
from itertools import combinations
from pathlib import Path

import moocore
import numpy as np
import pytest
from benchmarks.optimisers import contest, measures, page, players, runs
from benchmarks.optimisers.cases import NAMES, VALVE, Case, case_of
from benchmarks.optimisers.contest import Contest
from benchmarks.optimisers.players import Player
from benchmarks.optimisers.recorder import Recorder, RunOverError, entering

from toy_model import toy_problem


@pytest.fixture
def ours(monkeypatch):
    """Only our strategies play."""
    known = {name: player for name, player in players.players().items() if player.ours}
    for module in (contest, runs):
        monkeypatch.setattr(module, "players", lambda: known)
    return known


def toy_case():
    return Case("toy", toy_problem(), np.zeros(2), np.ones(2), 1.1)


def test_a_run_ends_at_its_budget_whatever_is_asked():
    problem = toy_problem()
    designs = problem.space.sample(70, np.random.default_rng(1))
    recorder = Recorder(problem, 100)
    recorder(designs)
    with pytest.raises(RunOverError):
        recorder(designs[::-1])
    assert recorder.count == 100
    asked = np.concatenate([designs, designs[::-1]])[:100]
    told = problem.tell(problem.simulate(asked))
    archive = recorder.archive()
    assert archive.evaluations == 100
    assert np.all(np.diff(archive.stamps) >= 0.0)
    assert np.array_equal(archive.F, told.F[archive.order - 1])
    assert told.feasible[archive.order - 1].all()


def test_a_run_goes_on_until_its_time_is_over():
    problem = toy_problem()
    designs = problem.space.sample(50, np.random.default_rng(1))
    recorder = Recorder(problem, 100, seconds=0.05)
    with pytest.raises(RunOverError):
        while True:
            recorder(designs)
    archive = recorder.archive()
    assert archive.evaluations > 100
    assert archive.lasts(0.05)


@pytest.mark.parametrize("k", [2, 3])
def test_what_enters_an_archive_is_what_nothing_before_it_dominates(k):
    F = np.random.default_rng(k).integers(0, 12, (900, k)).astype(float)
    marked = entering(F)
    expected = [not (F[:i] <= row).all(axis=1).any() for i, row in enumerate(F)]
    assert marked.tolist() == expected


@pytest.mark.parametrize("name", [name for name in NAMES if name != VALVE])
def test_a_known_front_is_non_dominated_and_nobody_beats_it(name):
    case = case_of(name)
    assert moocore.is_nondominated(case.front, keep_weakly=True).all()
    share = case.hypervolume(case.front) / case.volume
    assert 0.97 < share <= 1.0 + 1e-9
    found = runs.play(case, Player("goal_attainment", True), 1, 600)
    assert case.hypervolume(case.normalised(found.F)) <= case.volume * (1.0 + 1e-9)


def test_the_front_of_osy_has_its_ends():
    """By hand: x = (5, 1, 5, 0, 5, 0) has f = (-274, 76), and x = (1, 1, 1, 0, 1, 0) has f = (-42, 4)."""
    case = case_of("OSY")
    ends = case.front[[case.front[:, 0].argmin(), case.front[:, 1].argmin()]] * case.span + case.ideal
    assert ends == pytest.approx(np.array([[-274.0, 76.0], [-42.0, 4.0]]))


def test_the_best_subset_gives_up_the_least_point_again_and_again():
    random = np.random.default_rng(3)
    points = random.random((40, 3))
    points = points[moocore.is_nondominated(points)]
    size = len(points) - 1
    volumes = {
        rows: moocore.hypervolume(points[list(rows)], ref=np.full(3, 1.1))
        for rows in combinations(range(len(points)), size)
    }
    best = max(volumes, key=volumes.get)
    assert measures.best_subset(points, size, 1.1) == pytest.approx(points[list(best)])
    assert len(measures.best_subset(points, 5, 1.1)) == 5


def test_lambda_is_measured_against_the_optimum_of_each_direction(tmp_path, monkeypatch):
    file = tmp_path / "directions.csv"
    file.write_text("w1,w2,w3,optimum\n1,0,0,0.5\n0.5,0.25,0.25,1.0\n", "utf-8")
    monkeypatch.setattr(measures, "DIRECTIONS", file)
    measures.directions.cache_clear()
    F = np.array([[2.0, 0.0, 16.5e6], [1.0, 0.5e-6, 16.5e6 + 8.5e6]])
    # z = (1, 0, 0) and (0.5, 0.25, 1); over the first direction, floor 1e-3: 1 and 1000; over the second: 2 and 4
    assert measures.attainment_excess(F) == pytest.approx([1.0, 1.0])
    measures.directions.cache_clear()


def test_a_contest_is_played_measured_and_written(tmp_path, ours):
    played = Contest(tmp_path, ("BNH", "TNK"), (), (1, 2), (50, 200), workers=1)
    assert played.play() >= 2 * 2 * len(ours)
    assert played.play() == 0, "the runs are kept"
    values = played.values()
    shares = values[values["measure"] == measures.HV]
    assert set(shares["mark"]) == {"50", "200", measures.TIME}
    assert shares["value"].between(0.0, 1.0).all()
    assert set(shares["player"]) == set(ours)
    text = page.section(played, values, "a command", [])
    rows = (shares["case"] == "BNH") & (shares["mark"] == "50") & (shares["player"] == played.champion)
    assert f"| BNH | {shares[rows]['value'].median() * 100:.2f} |" in text
    file = tmp_path / "page.md"
    file.write_text("# Benchmarks\n\nothers\n", "utf-8")
    page.put(text, file)
    page.put(text, file)
    assert file.read_text("utf-8") == "# Benchmarks\n\nothers\n\n" + text


def test_a_replayed_run_is_the_same(tmp_path, ours):
    for player in ours.values():
        one, other = (runs.play(case_of("BNH"), player, 7, 300) for _ in range(2))
        assert np.array_equal(one.order, other.order)
        assert np.array_equal(one.F, other.F)


def test_peers_are_there_with_their_settings():
    for module, function, _ in players._PEERS.values():
        tree = ast.parse(Path(players.__file__).with_name(f"{module}.py").read_text("utf-8"))
        assert any(
            isinstance(node, ast.FunctionDef) and node.name == function and ast.get_docstring(node)
            for node in tree.body
        )
