"""Tests between samples against their definitions and against published numbers."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from divideropt.analysis import effect_size, holm, pair_tests, probability_above, several_test
from divideropt.analysis.ranking import least_p

SAMPLES = st.lists(st.integers(0, 6).map(float) | st.just(np.inf), min_size=1, max_size=8)


@given(SAMPLES, SAMPLES)
def test_the_effect_is_a_count_of_pairs(x, y):
    pairs = [1.0 if a > b else 0.5 if a == b else 0.0 for a in x for b in y]
    assert probability_above(np.array(x), np.array(y)) == pytest.approx(np.mean(pairs), abs=1e-12)


def test_p_is_the_part_of_all_orders_that_differ_as_much():
    """The exact test, counted out: all ways to deal nine values to samples of five and four."""
    x, y = [1.0, 2.5, 4.0, 8.0, 9.0], [0.5, 0.7, 2.0, 3.0]
    values = np.array(x + y)

    def statistic(rows):
        others = np.setdiff1d(np.arange(9), rows)
        return (values[list(rows)][:, None] > values[others]).sum()

    found = statistic(range(5))
    extreme = [abs(statistic(rows) - 10) >= abs(found - 10) for rows in combinations(range(9), 5)]
    [test] = pair_tests({"x": x, "y": y})
    assert test.p == pytest.approx(np.mean(extreme), rel=1e-12)
    assert test.effect == pytest.approx(found / 20, rel=1e-12)
    assert (test.first, test.second) == ("x", "y")


@pytest.mark.parametrize(("first", "second"), [(2, 2), (2, 4), (5, 5), (8, 3)])
def test_the_least_p_is_that_of_samples_apart(first, second):
    [test] = pair_tests({"x": list(range(first)), "y": list(range(100, 100 + second))})
    assert test.p == pytest.approx(least_p(first, second), rel=1e-12)
    assert test.effect == 0.0


def test_one_value_is_no_sample():
    [test] = pair_tests({"x": [1.0], "y": [2.0, 3.0, 4.0]})
    assert test.p is None
    assert test.effect is None
    assert several_test([[1.0, 2.0], [3.0], [4.0, 5.0]]) is None
    assert several_test([[1.0, 2.0], [3.0, 4.0]]) is None


def test_equal_samples_do_not_differ():
    [test] = pair_tests({"x": [1.0, 1.0], "y": [1.0, 1.0]})
    assert (test.p, test.effect) == (1.0, 0.5)
    assert several_test([[np.inf] * 3] * 3) == 1.0


def test_kruskal_and_wallis():
    """H = 12/(N(N + 1)) Σ R²/n - 3(N + 1) = 12/42 (4.5 + 24.5 + 60.5) - 21; with two degrees p = e^(-H/2)."""
    assert several_test([[1, 2], [3, 4], [np.inf, 6]]) == pytest.approx(np.exp(-(12 / 42 * 89.5 - 21) / 2), rel=1e-9)


def test_holm_by_hand():
    """0.005·4, 0.01·3, 0.03·2, and 0.04·1, which may not be below the one before."""
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.6, 0.7]) == [1.0, 1.0]
    assert holm([]) == []


@given(st.lists(st.floats(0, 1), min_size=1, max_size=7), st.floats(0.001, 0.5))
def test_holm_rejects_step_by_step(p, level):
    rejected = set()
    for step, row in enumerate(sorted(range(len(p)), key=lambda i: p[i])):
        if min(1.0, p[row] * (len(p) - step)) > level:
            break
        rejected.add(row)
    assert {i for i, value in enumerate(holm(p)) if value <= level} == rejected


@pytest.mark.parametrize(
    ("effect", "word"),
    [
        (0.5, "negligible"),
        (0.559, "negligible"),
        (0.56, "small"),
        (0.44, "small"),
        (0.64, "medium"),
        (0.3, "medium"),
        (0.71, "large"),
        (0.29, "large"),
        (0.0, "large"),
    ],
)
def test_the_words_of_vargha_and_delaney(effect, word):
    assert effect_size(effect) == word
