"""Choices against their definitions and closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from divideropt.analysis import (
    Scale,
    achievement,
    bulge,
    knee_points,
    meeting_goals,
    nondominated,
    pseudo_weights,
)
from divideropt.analysis.decision import AUGMENTATION, KNEE_RADIUS, LEAST_BULGE
from divideropt.strategies import reference_directions

POINTS = st.integers(1, 4).flatmap(
    lambda k: arrays(float, st.tuples(st.integers(1, 12), st.just(k)), elements=st.integers(0, 8).map(float))
)


def front_of(points):
    """Its non-dominated points, and the first of them twice."""
    front = points[nondominated(points)]
    return np.concatenate([front, front[:1]])


def simplex(k, exponent):
    """Points of Σ z_i^(1/exponent) = 1: bulging to the ideal point above 1, straight at 1, away from it below."""
    return np.where(reference_directions(k, 500) > 1e-3, reference_directions(k, 500), 0.0) ** exponent


@given(POINTS)
def test_a_knee_is_deeper_than_all_around_it(points):
    front = front_of(points)
    scale, depth = Scale.of(front), bulge(front)
    scaled = scale.apply(front)
    expected = []
    for i, here in enumerate(scaled):
        around = [j for j, there in enumerate(scaled) if j != i and abs(there - here).max() <= KNEE_RADIUS]
        first = all(depth[j] < depth[i] or (depth[j] == depth[i] and j > i) for j in around)
        if depth[i] >= LEAST_BULGE and first:
            expected.append(i)
    assert sorted(knee_points(front)) == expected


@pytest.mark.parametrize(("k", "depth"), [(2, 1 - 2 / 4), (3, 1 - 3 / 9)])
def test_the_knee_of_a_symmetric_front_is_its_middle(k, depth):
    """Where Σ √z_i = 1, all z_i are 1/k² in the middle."""
    front = simplex(k, 2.0) * np.logspace(-6, 6, k)
    rows = knee_points(front)
    assert Scale.of(front).apply(front)[rows[0]] == pytest.approx(np.full(k, 1 / k**2), abs=0.03)
    assert bulge(front)[rows[0]] == pytest.approx(depth, abs=0.01)
    assert len(rows) == 1


@pytest.mark.parametrize("k", [2, 3, 4])
@pytest.mark.parametrize("exponent", [1.0, 0.5])
def test_a_straight_front_and_a_hollow_one_have_no_knee(k, exponent):
    assert knee_points(simplex(k, exponent)) == []


def test_a_front_with_two_bulges_has_two_knees():
    x = np.linspace(0.0, 1.0, 201)
    front = np.column_stack([x, 1.0 - x - 0.15 * np.sin(2 * np.pi * x) ** 2])
    assert nondominated(front).all()
    knees = front[knee_points(front)]
    assert sorted(knees[:, 0]) == pytest.approx([0.25, 0.75], abs=0.011)


@pytest.mark.parametrize("front", [np.empty((0, 2)), np.ones((1, 3)), np.ones((4, 2)), np.arange(3.0)[:1, None]])
def test_without_a_trade_off_there_is_no_knee(front):
    assert knee_points(front) == []
    assert (bulge(front) == 0.0).all()


def test_an_objective_that_all_share_does_not_count():
    front = simplex(2, 2.0)
    wider = np.column_stack([front[:, 0], np.full(len(front), 7.0), front[:, 1]])
    assert knee_points(wider) == knee_points(front)
    assert pseudo_weights(wider)[:, [0, 2]] == pytest.approx(pseudo_weights(front))
    assert (pseudo_weights(wider)[:, 1] == 0.0).all()


def test_pseudo_weights_by_hand():
    """Deb 2001, section 8.3.2: the share of each objective's distance from its largest value."""
    F = np.array([[0.0, 30.0], [1.0, 20.0], [4.0, 10.0]])
    assert pseudo_weights(F) == pytest.approx(np.array([[1.0, 0.0], [0.75 / 1.25, 0.5 / 1.25], [0.0, 1.0]]))


@given(POINTS)
def test_pseudo_weights_are_shares_and_know_no_units(points):
    front = front_of(points)
    weights = pseudo_weights(front)
    assert weights.sum(axis=1) == pytest.approx(1.0)
    assert ((weights >= 0.0) & (weights <= 1.0)).all()
    factors = np.logspace(-3, 4, front.shape[1])
    assert pseudo_weights(front * factors + 2.0) == pytest.approx(weights, abs=1e-9)


@given(POINTS, st.data())
def test_what_is_chosen_is_efficient_and_follows_its_definition(points, data):
    k = points.shape[1]
    aspiration = np.array(data.draw(st.lists(st.floats(-4, 12), min_size=k, max_size=k)))
    scale = np.linspace(1.0, 3.0, k)
    values = achievement(points, aspiration, scale)
    expected = [max((p - aspiration) / scale) + AUGMENTATION * sum((p - aspiration) / scale) for p in points]
    assert values == pytest.approx(expected)
    best = points[values.argmin()]
    assert not ((points <= best).all(axis=1) & (points < best).any(axis=1)).any()


@given(POINTS, st.data())
def test_goals_are_met_where_nothing_is_above(points, data):
    k = points.shape[1]
    value = st.integers(1, 9).map(float) | st.just(np.nan) | st.just(-2.0)
    goals = np.array(data.draw(st.lists(value, min_size=k, max_size=k)))
    found = meeting_goals(points, goals)
    pairs = [[(v, g) for v, g in zip(p, goals, strict=True) if not np.isnan(g)] for p in points]
    if not pairs[0]:
        assert (found.nearest, found.meeting.tolist()) == (None, [])
        return
    assert found.meeting.tolist() == [i for i, pair in enumerate(pairs) if all(v <= g for v, g in pair)]
    worst = [max((v - g) / abs(g) for v, g in pair) for pair in pairs]
    assert found.nearest == worst.index(min(worst))
    nearest = points[found.nearest]
    assert found.lacks.tolist() == np.nan_to_num(np.maximum(nearest - goals, 0.0)).tolist()
