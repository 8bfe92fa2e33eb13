"""Comparisons of runs: what counts, what is measured, what is tested."""

import numpy as np
import pytest

from divideropt.analysis import INDICATORS, Contender, choose, compare, holm, hypervolume, region
from divideropt.models import Quantity
from divideropt.problem import AGGREGATES, Objective, Told

REFERENCE = np.array([2.0, 2.0])


def objectives(goal=0.4, count=2):
    return tuple(Objective(Quantity(f"f{i}", "", "", "", 1.0), goal) for i in range(count))


def contender(group, seed, distance, evaluations=60, infeasible_from=None):
    """A run that finds points at a distance from the front f1 + f2 = 1, each feasible unless said otherwise."""
    random = np.random.default_rng(seed)
    x = random.random(evaluations)
    F = np.column_stack([x, 1.0 - x]) + distance * (0.5 + 0.5 * random.random((evaluations, 1)))
    G = np.zeros((evaluations, 1))
    if infeasible_from is not None:
        G[infeasible_from:] = 1.0
    return Contender(group, f"{group}-{seed}", Told(F, G))


@pytest.fixture(name="runs", scope="module")
def _runs():
    return [contender(name, seed, d) for name, d in (("near", 0.1), ("far", 0.6), ("off", 0.3)) for seed in range(6)]


def test_each_indicator_prefers_the_nearer(runs):
    found = compare(runs, objectives(), REFERENCE)
    assert found.evaluations == 60
    assert list(found.groups) == ["near", "far", "off"]
    assert [t.indicator for t in found.tests] == list(INDICATORS)
    for tests in found.tests:
        first = tests.pairs[0]
        assert (first.first, first.second) == ("near", "far")
        assert first.effect > 0.9, tests.indicator
        assert tests.corrected[0] < 0.1
        assert tests.overall < 0.05


def test_p_values_are_corrected_over_all_that_is_tested(runs):
    found = compare(runs, objectives(), REFERENCE)
    p = [pair.p for tests in found.tests for pair in tests.pairs]
    assert len(p) == 3 * len(INDICATORS)
    assert [c for tests in found.tests for c in tests.corrected] == holm(p)


def test_values_are_those_of_the_first_evaluations_that_are_feasible():
    runs = [contender("a", 1, 0.5, 80, infeasible_from=30), contender("b", 2, 0.5, 40)]
    found = compare(runs, objectives(), REFERENCE)
    assert found.evaluations == 40
    F = runs[0].told.F[:30]
    assert found.scores[0].values["hypervolume"] == pytest.approx(hypervolume(F, REFERENCE), rel=1e-12)
    assert found.scores[0].values["attainment"] == AGGREGATES["goal_attainment"](F, objectives()).min()
    assert found.scores[0].front == sum(not np.any(np.less_equal(F, p).all(1) & np.less(F, p).any(1)) for p in F)


def test_nothing_is_better_than_the_best_known():
    """Also where a run's best in some direction is beyond the reference point."""
    x = np.linspace(0.0, 1.0, 30)
    tail = np.array([[-1e-3, 9.0], [9.0, -1e-3]])
    near = Contender("near", "near-1", Told(np.column_stack([x, 1.0 - x]), np.zeros((30, 1))))
    far = Contender("far", "far-1", Told(np.concatenate([near.told.F[:-2] + 0.1, tail]), np.zeros((30, 1))))
    for score in compare([near, far], objectives(), REFERENCE).scores:
        assert all(score.values[name] >= 0.0 for name in ("igd_plus", "epsilon", "mean_gap", "worst_gap"))


def test_runs_that_are_shorter_are_left_out():
    runs = [contender("a", 1, 0.5, 80), contender("b", 2, 0.5, 40), Contender("c", "c-1", Told(*np.empty((2, 0, 2))))]
    assert [c.run for c in compare(runs, objectives(), None).left_out] == ["c-1"]
    found = compare(runs, objectives(), None, 50)
    assert ([s.run for s in found.scores], [c.run for c in found.left_out]) == (["a-1"], ["b-2", "c-1"])
    assert found.tests == ()
    assert compare(runs, objectives(), None, 81) is None


def test_shares_of_the_front_of_all_add_up(runs):
    found = compare(runs, objectives(), REFERENCE, 25)
    F = np.concatenate([run.told.F[:25] for run in runs])
    count = sum(not np.any(np.less_equal(F, p).all(1) & np.less(F, p).any(1)) for p in F)
    assert sum(score.shared for score in found.scores) == count


def test_units_do_not_matter(runs):
    """Attainment apart, of which only the goals' unit is the objectives'."""
    factors = np.array([1e-6, 3e5])
    scaled = [Contender(r.group, r.run, Told(r.told.F * factors, r.told.G)) for r in runs]
    one, other = compare(runs, objectives(), REFERENCE), compare(scaled, objectives(), REFERENCE * factors)
    for mine, its in zip(one.scores, other.scores, strict=True):
        for name in INDICATORS.keys() - {"attainment"}:
            assert its.values[name] == pytest.approx(mine.values[name], rel=1e-6), name


def test_a_run_that_has_the_best_known_front_lacks_nothing():
    x = np.linspace(0.0, 1.0, 50)
    best = Contender("best", "best-1", Told(np.column_stack([x, 1.0 - x]), np.zeros((50, 1))))
    found = compare([best, contender("far", 1, 0.5, 50)], objectives(), REFERENCE)
    assert {k: found.scores[0].values[k] for k in ("igd_plus", "epsilon", "mean_gap", "worst_gap")} == {
        "igd_plus": 0.0,
        "epsilon": pytest.approx(0.0, abs=1e-12),
        "mean_gap": 0.0,
        "worst_gap": 0.0,
    }
    assert found.scores[1].shared == 0


def test_what_is_not_defined_is_not_compared():
    runs = [contender("a", 1, 0.5), contender("b", 2, 0.5)]
    found = compare(runs, (*objectives()[:1], *objectives(None)[1:]), None)
    assert found.scores[0].values["hypervolume"] is None
    assert found.scores[0].values["attainment"] is None
    assert [t.indicator for t in found.tests] == ["igd_plus", "epsilon", "mean_gap", "worst_gap"]
    assert all(t.pairs[0].p is None and t.corrected == (None,) and t.overall is None for t in found.tests)


def test_a_run_without_a_feasible_design_is_worst_and_all_such_are_nothing():
    empty = contender("b", 2, 0.5, infeasible_from=0)
    found = compare([contender("a", 1, 0.5), empty], objectives(), REFERENCE)
    values = found.scores[1].values
    assert (values.pop("hypervolume"), set(values.values())) == (0.0, {np.inf})
    assert compare([empty], objectives(), REFERENCE) is None


def test_one_objective_is_compared_too():
    random = np.random.default_rng(1)
    runs = [
        Contender(g, f"{g}-{i}", Told(random.random((20, 1)) + s, np.zeros((20, 1))))
        for g, s in (("a", 0.0), ("b", 0.5))
        for i in range(5)
    ]
    found = compare(runs, objectives(count=1), np.array([2.0]))
    assert {t.pairs[0].effect for t in found.tests} == {1.0}


def test_the_region_that_counts_is_within_the_reference_point():
    front = np.array([[0.0, 9.0], [1.0, 1.0], [2.0, 0.5], [5.0, 0.0]])
    assert region(front, None).tolist() == [True] * 4
    assert region(front, np.array([3.0, 3.0])).tolist() == [False, True, True, False]
    assert region(front, np.array([1.5, 3.0])).tolist() == [True] * 4, "one point has no extent"
    assert region(front, np.array([0.1, 0.1])).tolist() == [True] * 4, "no point"


def test_a_choice_is_of_rows_of_the_front():
    x = np.linspace(0.0, 1.0, 101)
    front = np.column_stack([x, (1.0 - np.sqrt(x)) ** 2])
    found = choose(front, objectives(0.3))
    assert front[list(found.knees)] == pytest.approx(np.array([[0.25, 0.25]]), abs=1e-9)
    assert found.depths == pytest.approx((0.5,))
    assert (front[found.goals.meeting] <= 0.3).all()
    assert found.weights.shape == (101, 2)
    assert front[found.wished] == pytest.approx([0.25, 0.25])
    assert choose(front, (*objectives(0.3)[:1], *objectives(None)[1:])).wished is None
