import numpy as np
import pytest

from divideropt.strategies import directions, reference_directions
from divideropt.strategies.directions import EDGE_SHARE, SMALLEST_WEIGHT, DirectionSequence


def test_the_directions_are_the_das_dennis_lattice_on_a_path_of_neighbours():
    found = reference_directions(3, 91)
    assert found.shape == (91, 3)
    assert np.isclose(np.where(found <= SMALLEST_WEIGHT, 0.0, found).sum(axis=1), 1.0).all()
    assert len(np.unique(found.round(9), axis=0)) == 91
    assert np.abs(np.diff(found, axis=0)).max() <= 2 / 12 + SMALLEST_WEIGHT


def test_fewer_directions_than_a_lattice_has_give_the_next_smaller_lattice():
    assert len(reference_directions(3, 90)) == 78
    assert len(reference_directions(2, 20)) == 20
    assert len(reference_directions(1, 20)) == 1


@pytest.mark.parametrize(("objectives", "most", "parts"), [(2, 11, 10), (3, 300, 23), (4, 84, 6), (5, 5, 1)])
def test_no_weight_is_below_the_floor_and_each_objective_has_a_corner(objectives, most, parts):
    found = reference_directions(objectives, most)
    assert found.min() == SMALLEST_WEIGHT
    assert ((found == 1.0).sum(axis=0) == 1).all()
    inner = found[found > SMALLEST_WEIGHT]
    assert np.allclose(inner * parts, (inner * parts).round())
    # from one direction to the next a single part moves
    steps = np.diff(np.where(found <= SMALLEST_WEIGHT, 0.0, found), axis=0) * parts
    assert np.allclose(np.abs(steps).sum(axis=1), 2.0)


def drawn(objectives, count, seed=1):
    return DirectionSequence(objectives, np.random.default_rng(seed)).draw(count)


@pytest.mark.parametrize("objectives", [2, 3, 5])
def test_what_is_drawn_lies_on_the_simplex_above_the_floor(objectives):
    found = drawn(objectives, 512)
    assert found.shape == (512, objectives)
    assert found.min() == SMALLEST_WEIGHT
    raised = (found == SMALLEST_WEIGHT).sum(axis=1)  # these were between 0 and the floor
    total = found.sum(axis=1)
    assert (total >= 1.0 - 1e-12).all()
    assert (total <= 1.0 + raised * SMALLEST_WEIGHT + 1e-12).all()


def test_a_share_of_the_directions_asks_nothing_of_one_objective_each_as_often():
    found = drawn(2, 4096)
    # Inside, a weight is below the floor where x/(1 - x) < 0.001^(1/1.5) = 0.01, x uniform; at both ends.
    inside = 2 * 0.01 / 1.01
    least = found == SMALLEST_WEIGHT
    assert least.any(axis=1).mean() == pytest.approx(EDGE_SHARE + (1 - EDGE_SHARE) * inside, abs=0.015)
    assert least[:, 0].sum() == pytest.approx(least[:, 1].sum(), rel=0.1)


def test_inside_they_fill_the_simplex_evenly_draw_after_draw(monkeypatch):
    monkeypatch.setattr(directions, "EDGE_SHARE", 0.0)
    monkeypatch.setattr(directions, "CORNER_POWER", 1.0)
    sequence = DirectionSequence(3, np.random.default_rng(1))
    draws = [sequence.draw(256) for _ in range(4)]

    def quarters(found):
        """The triangle's three corners, and its middle, have equal areas."""
        corners = (found > 0.5).sum(axis=0)
        return np.array([*corners, len(found) - corners.sum()])

    for found in (*draws, np.concatenate(draws)):
        # By chance, the standard deviation would be 7 in 256, 14 in 1024.
        assert np.abs(quarters(found) - len(found) / 4).max() <= 6
        assert np.allclose(found.mean(axis=0), 1 / 3, atol=3e-3)
    assert len(np.unique(np.concatenate(draws).round(9), axis=0)) == 1024


def test_small_weights_are_drawn_more_often_than_an_even_filling_would():
    found = drawn(3, 4096)
    inner = found[found.min(axis=1) > SMALLEST_WEIGHT]
    even = np.random.default_rng(2).dirichlet(np.ones(3), len(inner))
    assert (inner.min(axis=1) < 0.05).mean() > 1.5 * (even.min(axis=1) < 0.05).mean()


def test_a_seed_gives_the_same_directions_and_another_seed_others():
    assert drawn(3, 256).tobytes() == drawn(3, 256).tobytes()
    assert drawn(3, 256).tobytes() != drawn(3, 256, seed=2).tobytes()


def test_one_objective_has_one_direction():
    sequence = DirectionSequence(1, np.random.default_rng(1))
    assert sequence.draw(8).tolist() == [[1.0]] * 8
    assert reference_directions(1, 5).tolist() == [[1.0]]
