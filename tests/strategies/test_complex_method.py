"""The complex method: each variant's steps by numbers worked out by hand, and problems with known optima."""

import dataclasses

import numpy as np
import pytest

from divideropt.models.base import Domain, Parameter
from divideropt.problem import DesignSpace, Told, Variable
from divideropt.problem.problem import INFEASIBLE_MERIT
from divideropt.strategies import ComplexMethod
from divideropt.strategies.complex_method import Complex, search, search_all
from divideropt.strategies.complex_moves import VARIANTS, forgetting_share
from toy_model import toy_problem

POINTS = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 3.0], [4.0, 4.0]])
MERITS = np.array([0.0, 1.0, 2.0, 9.0])
CENTROID, BEST, WORST = np.array([2 / 3, 1.0]), np.zeros(2), np.array([4.0, 4.0])
REFLECTED = np.array([2 / 3 - 1.3 * 10 / 3, 1.0 - 1.3 * 3.0])


class Stop(Exception):
    """Ends a search."""


class Fixed:
    """R = 0.75 in every draw."""

    def random(self, count=None):
        return 0.75 if count is None else np.full(count, 0.75)


def box(lower, upper):
    return DesignSpace(
        tuple(
            Variable(Parameter(f"x{i}", "", "x", "", 0.0, Domain()), low, high)
            for i, (low, high) in enumerate(zip(lower, upper, strict=True))
        )
    )


def trials(variant, answers, space=None, held=None):
    """Return the trials of a search that is answered so, and the complex when the answers are at an end."""
    held = held or Complex(POINTS.copy(), MERITS.copy())
    asked, answers = [], iter(answers)

    def score(designs):
        answer = next(answers, None)
        if answer is None:
            raise Stop
        asked.append(designs[0].copy())
        return np.array([answer])

    with pytest.raises(Stop):
        search(held, score, space or box([-10, -10], [10, 10]), Fixed(), variant)
    return np.array(asked), held


def minimise(function, space, variant, seed, evaluations=1000):
    """Return the best that a variant with its restarts comes to, and what it asked for."""
    asked = []

    def score(designs):
        if len(asked) + len(designs) > evaluations:
            raise Stop
        asked.extend(designs.copy())
        return np.array([function(x) for x in designs])

    with pytest.raises(Stop):
        search_all(score, space, 2 * len(space), variant, np.random.default_rng(seed))
    return min(asked, key=function), asked


def test_box_retreats_half_way_to_the_centroid_while_the_trial_is_the_worst():
    asked, held = trials(VARIANTS["box"], [5.0, 3.0, 1.5])
    halves = [CENTROID + (REFLECTED - CENTROID) / 2**i for i in range(3)]
    assert np.allclose(asked, halves)
    assert np.allclose(held.points[3], halves[2])
    assert held.merits[3] == 1.5


def test_box_puts_a_trial_just_inside_the_bounds():
    asked, _ = trials(VARIANTS["box"], [5.0], box([-2, -10], [8, 10]))
    assert asked[0, 0] == -2 + 10e-6
    assert np.isclose(asked[0, 1], REFLECTED[1])


@pytest.mark.parametrize("name", ["guin", "author"])
def test_the_retreats_of_c7_turn_to_the_best_point(name):
    asked, held = trials(VARIANTS[name], [10.0, 9.5, 8.0])
    expected = [REFLECTED]
    for k in (1, 2):
        e = (4 / (4 + k + 1)) ** ((4 + k - 1) / 4)
        towards = (expected[-1] + e * CENTROID + (1 - e) * BEST) / 2
        expected.append(towards + (CENTROID - BEST) * (1 - e) * (2 * 0.75 - 1))
    assert np.allclose(asked, expected)
    assert held.merits[3] == 8.0  # better than what it replaces, though still the worst


def test_the_author_takes_a_reflection_as_bad_as_the_worst_but_no_such_retreat():
    assert np.allclose(trials(VARIANTS["author"], [9.0])[1].points[3], REFLECTED)
    assert np.allclose(trials(VARIANTS["guin"], [9.0])[1].points[3], WORST)
    assert np.allclose(trials(VARIANTS["author"], [9.1, 9.0])[1].points[3], WORST)


def test_the_author_retreats_without_end_and_clips_to_the_bound_itself():
    asked, _ = trials(VARIANTS["author"], [10.0] * 40, box([-2, -10], [8, 10]))
    assert len(asked) == 40
    assert asked[0, 0] == -2.0


def test_complex_rf_adds_noise_in_proportion_to_the_span_and_turns_to_the_best_by_and_by():
    variant = dataclasses.replace(VARIANTS["complex_rf"], forgetting=0.0)
    asked, _ = trials(variant, [10.0, 10.0, 10.0])
    noise = 0.3 * 20 * (4 / 20) * (0.75 - 0.5)
    first = REFLECTED + noise
    second = (first + CENTROID) / 2 + noise
    share = 1 - np.exp(-1 / 4)
    third = (second + (1 - share) * CENTROID + share * BEST) / 2 + noise
    assert np.allclose(asked, [first, second, third])


def test_a_reflection_that_is_the_best_is_expanded_and_the_better_of_both_kept():
    variant = dataclasses.replace(VARIANTS["box"], expansion=2.0)
    twice = CENTROID + 2 * (REFLECTED - CENTROID)
    asked, held = trials(variant, [-1.0, -2.0])
    assert np.allclose(asked, [REFLECTED, twice])
    assert np.allclose(held.points[3], twice)
    assert np.allclose(trials(variant, [-1.0, -0.5])[1].points[3], REFLECTED)


def test_a_reflection_worse_than_what_it_replaces_turns_back_and_then_retreats_as_ever():
    variant = dataclasses.replace(VARIANTS["box"], contraction=True)
    back = (WORST + CENTROID) / 2
    asked, _ = trials(variant, [9.5, 8.0, 7.0])
    assert np.allclose(asked, [REFLECTED, back, (back + CENTROID) / 2])
    asked, _ = trials(variant, [8.5, 1.0])
    assert np.allclose(asked, [REFLECTED, (REFLECTED + CENTROID) / 2])


def test_a_search_leaves_what_was_asked_and_told_as_it_was():
    told = []

    def score(designs):
        told.append((designs, values := (designs**2).sum(axis=1), designs.copy(), values.copy()))
        if len(told) > 200:
            raise Stop
        return values

    with pytest.raises(Stop):
        search_all(score, box([-1, -1], [1, 1]), 4, VARIANTS["robust"], np.random.default_rng(1))
    for designs, values, designs_then, values_then in told:
        assert designs.tobytes() == designs_then.tobytes()
        assert values.tobytes() == values_then.tobytes()


def test_forgetting_makes_old_values_worse_and_leaves_the_raw_ones_alone():
    share = forgetting_share(1.3, 0.3, 4)
    assert np.isclose(share, 1 - 0.65**0.075)
    held = Complex(POINTS.copy(), np.array([0.0, 1.0, 2.0, 4.0]))
    held.age(share)
    held.replace(3, WORST, 2.0 + 2 * share)
    assert np.allclose(held.aged, [4 * share, 1 + 4 * share, 2 + 4 * share, 2 + 2 * share])
    assert held.merits.tolist() == [0.0, 1.0, 2.0, 2 + 2 * share]
    assert (held.worst, int(held.merits.argmax())) == (2, 3)  # what is older is worse


def test_a_forgotten_best_is_still_the_best():
    held = Complex(POINTS.copy(), MERITS.copy())
    for _ in range(1000):
        held.age(0.1)
        held.replace(1, POINTS[1], 1.0)
    assert int(held.aged.argmin()) == 1
    assert held.best == 0


def test_the_infeasible_do_not_stretch_what_is_forgotten():
    held = Complex(POINTS.copy(), np.array([0.0, 1.0, 2.0, INFEASIBLE_MERIT + 5]))
    held.age(0.1)
    assert np.allclose(held.aged, [0.2, 1.2, 2.2, INFEASIBLE_MERIT + 5])


@pytest.mark.parametrize("name", VARIANTS)
def test_every_variant_finds_the_centre_of_a_bowl_and_a_corner(name):
    best, _ = minimise(lambda x: float(((x - 0.3) ** 2).sum()), box([0, 0, 0], [1, 1, 1]), VARIANTS[name], seed=3)
    assert np.allclose(best, 0.3, atol=0.02)
    best, _ = minimise(lambda x: float(x[0] - x[1]), box([-1, -1], [1, 1]), VARIANTS[name], seed=1)
    assert np.allclose(best, [-1.0, 1.0], atol=0.02)


@pytest.mark.parametrize("name", ["robust", "box", "guin", "complex_rf"])
def test_an_infeasible_start_is_led_to_feasibility_before_the_objective_counts(name):
    """Feasible is a corner of a millionth of the box; the objective draws away from it."""

    def merit(x):
        violation = float(np.maximum(x - 0.01, 0).sum())
        return INFEASIBLE_MERIT + violation if violation > 0 else float(-x.sum())

    best, asked = minimise(merit, box([0, 0, 0], [1, 1, 1]), VARIANTS[name], seed=2)
    feasible = np.array([merit(x) < INFEASIBLE_MERIT for x in asked])
    first = int(feasible.argmax())
    assert 6 <= first < 1000
    assert np.allclose(best, 0.01, atol=1e-3)
    fresh = np.array(asked[first + 1 : first + 7])  # a new complex, but for one point, which is the feasible one
    assert (fresh.max(axis=0) - fresh.min(axis=0) > 0.3).all()


def test_infeasible_points_move_half_way_to_the_centroid_of_the_feasible():
    """On a line: feasible up to 0.5. Each infeasible start halves its distance until it is inside."""

    def merit(x):
        return float(x[0]) if x[0] <= 0.5 else INFEASIBLE_MERIT + float(x[0])

    _, asked = minimise(merit, box([0, 0], [1, 1]), VARIANTS["box"], seed=6, evaluations=20)
    start = np.array(asked[:4])
    inside = start[:, 0] <= 0.5
    assert 0 < inside.sum() < 4
    moved = np.array(asked[4 : 4 + (~inside).sum()])
    assert np.allclose(moved, (start[~inside] + start[inside].mean(axis=0)) / 2)


@pytest.mark.parametrize(("restart", "count", "extent"), [("best", 19, 0.6), ("fresh", 20, 1.0), ("none", 0, 0.0)])
def test_a_restart_is_around_the_best_or_anywhere_or_not_at_all(restart, count, extent):
    variant = dataclasses.replace(VARIANTS["box"], restart=restart, tolerance=0.05)
    batches = []

    def score(designs):
        batches.append(designs.copy())
        if len(batches) > 1 and len(designs) > 1:
            raise Stop
        return ((designs - 0.3) ** 2).sum(axis=1)

    space, random = box([0, 0, 0], [1, 1, 1]), np.random.default_rng(1)
    if restart == "none":
        search_all(score, space, 20, variant, random)
        assert {len(batch) for batch in batches[1:]} == {1}
    else:
        with pytest.raises(Stop):
            search_all(score, space, 20, variant, random)
        assert len(batches[-1]) == count
        assert np.ptp(batches[-1], axis=0).max() <= extent


def test_the_options_of_a_campaign_override_the_variants():
    """A variant with the options of another asks for what that asks for."""

    def asked(strategy):
        problem, batches = toy_problem(), []

        def evaluate(designs):
            batches.append(designs.copy())
            return problem.tell(problem.simulate(designs))

        strategy.run(problem, evaluate, seed=4)
        return np.concatenate(batches).tobytes()

    own = VARIANTS["complex_rf"]
    spelled = ComplexMethod(
        variant="complex_rf",
        evaluations=200,
        reflection=own.reflection,
        randomisation=own.randomisation,
        forgetting=own.forgetting,
        tolerance=own.tolerance,
        restart=own.restart,
    )
    plain = ComplexMethod(variant="complex_rf", evaluations=200)
    assert asked(spelled) == asked(plain)
    changes = {"reflection": 1.4, "randomisation": 0.0, "forgetting": 0.0, "tolerance": 0.2}
    for name, value in changes.items():
        assert asked(dataclasses.replace(plain, **{name: value})) != asked(plain)


def test_infeasible_points_are_left_behind():
    problem = toy_problem()
    told = problem.tell(problem.simulate(np.array([[0.5, 0.01, 0.5], [0.5, 0.5, 0.5], [0.05, 0.5, 0.5]])))
    assert told.feasible.tolist() == [False, True, False]
    assert told.violation[0] > told.violation[2] > told.violation[1] == 0.0


def test_a_single_variable_has_a_complex_of_three():
    space = box([0], [1])
    problem, spent = dataclasses.replace(toy_problem(), space=space), []

    def evaluate(designs):
        spent.append(len(designs))
        F = np.column_stack([designs[:, 0], (designs[:, 0] - 1) ** 2])
        return Told(F, np.zeros((len(designs), problem.constraint_count)))

    ComplexMethod(evaluations=100).run(problem, evaluate, seed=1)
    assert spent[0] == 3
