"""Indicators against their definitions, and against the paper's example."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from divideropt.analysis import (
    additive_epsilon,
    gaps,
    hypervolume,
    hypervolume_contributions,
    igd_plus,
    multiplicative_epsilon,
    nondominated,
    reached,
)
from divideropt.strategies import reference_directions


def sets(least=1):
    """Two sets of points with as many objectives, on a coarse lattice, so that there are ties."""
    value = st.integers(1, 9).map(lambda i: i / 8)
    return st.integers(1, 4).flatmap(
        lambda k: st.tuples(*(arrays(float, st.tuples(st.integers(least, 7), st.just(k)), elements=value),) * 2)
    )


@given(sets())
def test_igd_plus_is_the_mean_distance_to_what_is_dominated(both):
    F, front = both
    nearest = [min(np.linalg.norm(np.maximum(point - target, 0.0)) for point in F) for target in front]
    assert igd_plus(F, front) == pytest.approx(np.mean(nearest), abs=1e-12)


@given(sets())
def test_epsilon_is_the_least_shift_or_factor(both):
    F, front = both
    shift = max(min((point - target).max() for point in F) for target in front)
    factor = max(min((point / target).max() for point in F) for target in front)
    assert additive_epsilon(F, front) == pytest.approx(shift, abs=1e-12)
    assert multiplicative_epsilon(F, front) == pytest.approx(factor, abs=1e-12)


def test_igd_plus_of_the_paper():
    front = np.array([[10, 0], [6, 1], [2, 2], [1, 6], [0, 10]], dtype=float)
    better = np.array([[4, 2], [3, 3], [2, 4]], dtype=float)
    worse = np.array([[8, 2], [4, 4], [2, 8]], dtype=float)
    assert igd_plus(better, front) == pytest.approx(1.482842712474619, rel=1e-12)  # Ishibuchi et al. 2015, example 4
    assert igd_plus(worse, front) == pytest.approx(2.260112615949154, rel=1e-12)


def test_an_empty_set_is_worse_than_any_other():
    none, front = np.empty((0, 2)), np.array([[0.0, 1.0]])
    assert igd_plus(none, front) == additive_epsilon(none, front) == multiplicative_epsilon(none, front) == np.inf
    assert len(hypervolume_contributions(none, np.ones(2))) == 0


def test_a_factor_needs_values_above_zero():
    with pytest.raises(ValueError, match="larger than 0"):
        multiplicative_epsilon(np.array([[0.0, 1.0]]), np.array([[1.0, 1.0]]))


@given(sets())
def test_a_contribution_is_what_the_hypervolume_loses(both):
    F, _ = both
    reference = np.full(F.shape[1], 1.25)
    F = F[nondominated(F)]
    F = np.concatenate([F, F[:1], F[:1] + 0.125])
    whole = hypervolume(F[:-2], reference)
    lost = [whole - hypervolume(np.delete(F[:-2], i, axis=0), reference) for i in range(len(F) - 2)]
    assert hypervolume_contributions(F, reference) == pytest.approx([0.0, *lost[1:], 0.0, 0.0], abs=1e-12)


@given(sets())
def test_what_is_reached_is_the_least_of_the_largest(both):
    F, weights = both
    ideal, scale = np.full(F.shape[1], 0.125), np.linspace(1.0, 2.0, F.shape[1])
    expected = [min(max((point - ideal) / scale / w) for point in F) for w in weights]
    assert reached(F, weights, ideal, scale) == pytest.approx(expected, abs=1e-12)


def test_what_is_reached_on_a_straight_front():
    """A point t of z1 + z2 = 1 has max(t/w1, (1 - t)/w2); with w1 + w2 = 1 the least is 1, where t = w1."""
    t = np.linspace(0.0, 1.0, 100_001)
    directions = reference_directions(2, 91)
    found = reached(np.column_stack([t, 1.0 - t]), directions, np.zeros(2), np.ones(2))
    assert len(found) == 91
    assert found == pytest.approx(1.0 / directions.sum(axis=1), rel=1e-3)


def test_no_point_reaches_nothing_and_gaps_are_shares():
    directions = reference_directions(3, 91)
    assert len(directions) == 91
    assert (reached(np.empty((0, 3)), directions, np.zeros(3), np.ones(3)) == np.inf).all()
    assert gaps(np.array([0.0, 1.0, 1.1, np.inf]), np.array([0.0, 0.0, 1.0, 1.0])) == pytest.approx(
        [0.0, np.inf, 0.1, np.inf]
    )
