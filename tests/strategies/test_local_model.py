import numpy as np
import pytest

from divideropt.strategies import local_model
from divideropt.strategies.local_model import (
    FULL_UP_TO,
    POINTS_A_COEFFICIENT,
    STEP_PRECISION,
    LocalModel,
    points_wanted,
)


def quadratics(d, m, seed):
    """Random constants, shape (m,), slopes, (m, d), and symmetric curvatures, (m, d, d)."""
    random = np.random.default_rng(seed)
    half = random.standard_normal((m, d, d))
    return random.standard_normal(m), random.standard_normal((m, d)), half + half.transpose(0, 2, 1)


def values_of(s, constants, slopes, curvatures):
    return constants + s @ slopes.T + 0.5 * np.einsum("ni,mij,nj->nm", s, curvatures, s)


def fitted(d, terms, seed=3):
    random = np.random.default_rng(seed)
    centre, radius = np.full(d, 0.4), 0.05
    s = 2 * random.random((points_wanted(d), d)) - 1
    return LocalModel.fitted(centre, radius, centre + radius * s, values_of(s, *terms))


@pytest.mark.parametrize("d", [1, 2, 5])
def test_without_a_ridge_it_is_the_quadratic_itself(d, monkeypatch):
    monkeypatch.setattr(local_model, "RIDGE", (0.0, 0.0, 0.0))
    terms = quadratics(d, 3, seed=d)
    model = fitted(d, terms)
    for found, expected in zip((model.constants, model.slopes, model.curvatures), terms, strict=True):
        assert np.allclose(found, expected, atol=1e-6)


@pytest.mark.parametrize("d", [1, 2, 5])
def test_the_ridge_leaves_planes_as_they_are_and_quadratics_nearly(d):
    constants, slopes, curvatures = quadratics(d, 3, seed=d)
    plane = fitted(d, (constants, slopes, 0.0 * curvatures))
    assert np.allclose(plane.constants, constants, atol=1e-6)
    assert np.allclose(plane.slopes, slopes, atol=1e-6)
    assert np.abs(plane.curvatures).max() < 1e-6
    curved = fitted(d, (constants, slopes, curvatures))
    assert np.allclose(curved.curvatures, curvatures, atol=1e-3)


def test_what_designs_do_not_tell_stays_small():
    """All designs lie on a line: the slope across it is not to be had."""
    s = np.zeros((30, 2))
    s[:, 0] = np.linspace(-1, 1, 30)
    model = LocalModel.fitted(np.array([0.5, 0.5]), 0.1, 0.5 + 0.1 * s, 2.0 * s[:, :1])
    assert model.slopes[0] == pytest.approx([2.0, 0.0], abs=1e-6)


def test_the_middle_counts_more_than_the_rim():
    """A cube has no quadratic: fitted with equal weights, its slope at 0 would be 3/5."""
    s = np.linspace(-1, 1, 201)[:, None]
    slope = LocalModel.fitted(np.array([0.5]), 0.1, 0.5 + 0.1 * s, s**3).slopes[0, 0]
    assert 0.0 < slope < 0.4


def test_many_variables_have_curvatures_of_their_own_only():
    d = FULL_UP_TO + 2
    assert points_wanted(d) == POINTS_A_COEFFICIENT * (1 + 2 * d)
    assert points_wanted(FULL_UP_TO) == POINTS_A_COEFFICIENT * (1 + FULL_UP_TO) * (2 + FULL_UP_TO) // 2
    constants, slopes, curvatures = quadratics(d, 2, seed=8)
    separable = curvatures * np.eye(d)
    model = fitted(d, (constants, slopes, separable))
    assert (model.curvatures[:, ~np.eye(d, dtype=bool)] == 0.0).all()
    assert np.allclose(model.curvatures, separable, atol=2e-3)
    assert np.allclose(model.slopes, slopes, atol=1e-4)


CENTRE, RADIUS = np.array([0.5, 0.3]), 0.1
SLOPES = np.array([[-1.0, 0.2], [0.5, -0.7], [0.9, 0.4]])
CURVATURES = np.array([[[1.2, 0.3], [0.3, 0.8]], [[0.5, -0.2], [-0.2, 1.5]], [[0.4, 0.0], [0.0, 0.2]]])


def stepped(weights, reach, limit, centre=CENTRE):
    """Step, hold the step against a dense grid of all that is allowed; return attainment and constraint there."""
    constants = np.array([0.3, 0.1, limit])
    design, gain = LocalModel(centre, RADIUS, constants, SLOPES, CURVATURES).step(weights, reach)
    assert np.abs(design - centre).max() <= reach + 1e-12
    assert ((design >= 0.0) & (design <= 1.0)).all()

    def values(designs):
        return values_of((designs - centre) / RADIUS, constants, SLOPES, CURVATURES)

    axes = [np.linspace(max(0.0, c - reach), min(1.0, c + reach), 201) for c in centre]
    grid = values(np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2))
    best = (grid[grid[:, 2] <= 0.0, :2] - np.log(weights)).max(axis=1).min()
    there = values(design[None])[0]
    attained = (there[:2] - np.log(weights)).max()
    assert there[2] <= 1e-5
    assert attained <= best + 2 * STEP_PRECISION
    assert gain == pytest.approx((constants[:2] - np.log(weights)).max() - attained, abs=2 * STEP_PRECISION)
    return attained, there[2]


@pytest.mark.parametrize("weights", [[0.5, 0.5], [0.8, 0.2], [0.15, 0.85], [0.999, 0.001]])
@pytest.mark.parametrize("reach", [0.02, 0.1])
@pytest.mark.parametrize("limit", [-9.0, -0.3, -0.05])
def test_a_step_is_as_good_as_the_best_of_a_dense_grid(weights, reach, limit):
    """Also where the third value, a constraint, is far from its limit of 0, may come to it, or is near."""
    stepped(np.array(weights), reach, limit)


def test_a_constraint_in_the_way_is_met_exactly_and_costs_some_of_the_gain():
    weights = np.array([0.2, 0.8])
    free, _ = stepped(weights, 0.1, -9.0)
    held, constraint = stepped(weights, 0.1, -0.1)
    assert held > free + 0.1
    assert constraint == pytest.approx(0.0, abs=1e-5)


def test_what_the_reach_stops_goes_further_with_more():
    weights = np.array([0.2, 0.8])
    assert stepped(weights, 0.04, -9.0)[0] < stepped(weights, 0.02, -9.0)[0] - 0.05


@pytest.mark.parametrize("centre", [[0.0, 0.3], [0.97, 1.0], [0.02, 0.99]])
def test_a_step_stays_in_the_box(centre):
    stepped(np.array([0.5, 0.5]), 0.1, -9.0, np.array(centre))
