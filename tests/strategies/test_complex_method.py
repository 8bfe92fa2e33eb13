"""The complex method against what C.7 does, and on problems with known optima."""

import numpy as np
import pytest

from divideropt.models.base import Domain, Parameter
from divideropt.problem import DesignSpace, Variable
from divideropt.strategies.complex_method import COLLAPSED, Complex, search
from toy_model import toy_problem


def box(lower, upper):
    return DesignSpace(
        tuple(
            Variable(Parameter(f"x{i}", "", "x", "", 0.0, Domain()), low, high)
            for i, (low, high) in enumerate(zip(lower, upper, strict=True))
        )
    )


def minimise(function, space, points, seed):
    random = np.random.default_rng(seed)
    start = space.sample(points, random)
    held = Complex(start.copy(), np.array([function(x) for x in start]))
    search(held, lambda designs: np.array([function(x) for x in designs]), space, random)
    return held


def test_it_finds_the_centre_of_a_bowl():
    held = minimise(lambda x: float(((x - 0.3) ** 2).sum()), box([0, 0, 0], [1, 1, 1]), 6, seed=3)
    assert np.allclose(held.points[held.best], 0.3, atol=100 * COLLAPSED)


def test_it_finds_an_optimum_in_a_corner():
    held = minimise(lambda x: float(x[0] - x[1]), box([-1, -1], [1, 1]), 4, seed=1)
    assert np.allclose(held.points[held.best], [-1.0, 1.0], atol=1e-3)


def test_the_first_trial_is_the_reflection_and_the_next_retreats_as_in_c7():
    space = box([-10, -10], [10, 10])
    points = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 3.0], [4.0, 4.0]])
    merits = np.array([0.0, 1.0, 2.0, 9.0])
    trials = []

    def score(designs):
        trials.append(designs[0].copy())
        return np.array([10.0 if len(trials) < 3 else -1.0])

    class Stop(Exception):
        pass

    class Fixed:
        """R = 0.75 in every retreat."""

        calls = 0

        def random(self):
            return 0.75

    def score_three(designs):
        if len(trials) == 3:
            raise Stop
        return score(designs)

    with pytest.raises(Stop):
        search(Complex(points, merits), score_three, space, Fixed())
    centroid, best, worst = np.array([2 / 3, 1.0]), np.zeros(2), np.array([4.0, 4.0])
    reflected = centroid + 1.3 * (centroid - worst)
    assert np.allclose(trials[0], reflected)
    expected = reflected
    for k, trial in zip((1, 2), trials[1:], strict=True):
        e = (4 / (4 + k + 1)) ** ((4 + k - 1) / 4)
        expected = (expected + e * centroid + (1 - e) * best) / 2 + (centroid - best) * (1 - e) * (2 * 0.75 - 1)
        assert np.allclose(trial, expected)


def test_infeasible_points_are_left_behind():
    problem = toy_problem()
    told = problem.tell(problem.simulate(np.array([[0.5, 0.01, 0.5], [0.5, 0.5, 0.5], [0.05, 0.5, 0.5]])))
    assert told.feasible.tolist() == [False, True, False]
    assert told.violation[0] > told.violation[2] > told.violation[1] == 0.0
