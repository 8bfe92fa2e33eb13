"""The estimators of Sobol indices against closed forms, and against SALib's."""

import numpy as np
import pytest
from SALib.analyze.sobol import analyze

from divideropt.analysis.blocks import Blocks, blocks_of
from divideropt.analysis.pick_freeze import RESAMPLES, by_pairs, size_of, whole
from divideropt.analysis.saltelli import saltelli_terms
from sensitivity_models import GFunction, Ishigami, g_indices, ishigami_indices, sample


def expected(blocks, names, closed):
    first, total, second = closed
    tables = {"S1": first, "ST": total}
    return np.array([tables[k][names[i]] if j is None else second[names[i], names[j]] for k, i, j in blocks.keys])


@pytest.mark.parametrize(("model", "closed"), [(Ishigami(), ishigami_indices()), (GFunction(), g_indices())])
@pytest.mark.parametrize("pairs", [False, True])
def test_every_index_is_within_its_interval_of_the_closed_form(model, closed, pairs):
    """95 % intervals one by one, not widened for their number: the bootstrap takes the blocks for random ones, and a
    Sobol sequence errs less."""
    designs = sample(model, 4096)
    blocks = blocks_of(designs)
    values = model.evaluate(designs)[0][:, 0].reshape(-1, blocks.size)
    found = by_pairs(values, np.full(values.shape, True), blocks, 32) if pairs else whole(values, blocks)
    errors = np.abs(found.values - expected(blocks, list(model.parameters), closed))
    assert (errors <= found.half).all()
    assert (found.half < 0.15).all()
    assert (found.used == 1.0).all()


@pytest.mark.parametrize("second_order", [False, True])
def test_indices_and_widths_are_those_of_salib(second_order):
    model = Ishigami()
    designs = sample(model, 2048, second_order)
    blocks = blocks_of(designs)
    values = model.evaluate(designs)[0][:, 0]
    found = whole(values.reshape(-1, blocks.size), blocks)
    names = list(model.parameters)
    description = {"num_vars": 3, "names": names, "bounds": [[-np.pi, np.pi]] * 3}
    theirs = analyze(description, values, calc_second_order=second_order, num_resamples=1000, seed=1)
    flat = [*theirs["S1"], *theirs["ST"]] + [theirs["S2"][pair] for pair in blocks.pairs]
    widths = [*theirs["S1_conf"], *theirs["ST_conf"]] + [theirs["S2_conf"][pair] for pair in blocks.pairs]
    np.testing.assert_allclose(found.values, flat, rtol=1e-12, atol=1e-14)
    chance = 4 / np.sqrt(2 * RESAMPLES)  # four standard errors of a standard deviation from so many resamples
    np.testing.assert_allclose(found.half, widths, rtol=chance)


@pytest.mark.parametrize("exponent", [1000, 600, -600, -1015])
@pytest.mark.parametrize("pairs", [False, True])
def test_the_size_of_a_quantity_changes_no_digit(exponent, pairs):
    """Squares of such numbers are infinite or 0, and so were the indices."""
    model = GFunction()
    designs = sample(model, 64)
    blocks = blocks_of(designs)
    values = model.evaluate(designs)[0][:, 0].reshape(-1, blocks.size)
    kept = np.full(values.shape, True)
    plain, scaled = (
        by_pairs(found, kept, blocks, 32) if pairs else whole(found, blocks)
        for found in (values, values * 2.0**exponent)
    )
    assert (np.abs(plain.values) > 0.0).all()
    np.testing.assert_array_equal(scaled.values, plain.values)
    np.testing.assert_array_equal(scaled.half, plain.half)


@pytest.mark.parametrize("values", [[0.0], [1.0, -1.5], [1e308], [5e-324], [-3e-310, 0.0]])
def test_what_is_divided_by_its_size_has_squares(values):
    size = size_of(np.array(values))
    assert np.isfinite(size)
    assert size > 0.0
    assert np.frexp(size)[0] == 0.5  # a power of two
    assert np.abs(np.array(values) / size).max() < 2.0


def test_a_resample_in_which_nothing_varies_makes_no_noise():
    """Warnings are errors here. One resample in eight misses both blocks that are out of line; mean and deviation of
    the values are 0 and 4 without rounding, so that the variance of what is left is 0."""
    blocks = Blocks(3, second_order=True)
    values = np.ones((34, blocks.size))
    values[[5, 20]] = -16.0
    found = whole(values, blocks)
    assert np.isfinite(found.values).all()
    assert np.isnan(found.half).all()


def test_what_varies_only_where_no_variance_is_taken_has_no_indices():
    """SALib warns and says 0."""
    blocks = blocks_of(sample(GFunction(), 32))
    values = np.ones((32, blocks.size))
    values[5, 1] = 2.0
    assert np.isnan(whole(values, blocks).values).all()


def test_our_own_terms_make_the_indices_of_salib():
    model = GFunction()
    designs = sample(model, 256)
    blocks = blocks_of(designs)
    values = model.evaluate(designs)[0][:, 0].reshape(-1, blocks.size)
    terms, combine = saltelli_terms((values - values.mean()) / values.std(), blocks)
    np.testing.assert_allclose(
        combine(terms.mean(axis=0)[None])[0], whole(values, blocks).values, rtol=1e-10, atol=1e-12
    )


@pytest.mark.parametrize("second_order", [False, True])
def test_the_layout_is_recognised(second_order):
    assert blocks_of(sample(GFunction(), 4, second_order)) == Blocks(6, second_order)


def test_a_sample_of_another_kind_is_refused():
    designs = np.random.default_rng(1).random((40, 3))
    with pytest.raises(ValueError, match="no Sobol sample"):
        blocks_of(designs)
    with pytest.raises(ValueError, match="less than one block"):
        blocks_of(sample(GFunction(), 4)[:5])


def test_what_the_lost_designs_hold_changes_no_index():
    model = Ishigami()
    designs = sample(model, 512)
    blocks = blocks_of(designs)
    values = model.evaluate(designs)[0][:, 0].reshape(-1, blocks.size)
    kept = (designs[:, 0] > -1.0).reshape(values.shape)
    one = by_pairs(np.where(kept, values, np.nan), kept, blocks, 32)
    other = by_pairs(np.where(kept, values, 1e9), kept, blocks, 32)
    np.testing.assert_array_equal(one.values, other.values)
    np.testing.assert_array_equal(one.half, other.half)


def test_pairs_of_a_smaller_box_give_the_indices_of_that_box():
    """Where only the end of one variable's range fails, what is kept is a box, and the indices are its own."""
    model = GFunction()
    designs = sample(model, 8192)
    blocks = blocks_of(designs)
    values = model.evaluate(designs)[0][:, 0].reshape(-1, blocks.size)
    kept = (designs[:, 0] >= 0.5).reshape(values.shape)  # half of the symmetric |4 x1 - 2|: the same distribution
    found = by_pairs(values, kept, blocks, 32)
    errors = np.abs(found.values - expected(blocks, list(model.parameters), g_indices()))
    assert (errors <= found.half).all()
    assert found.used[0] == pytest.approx(0.5, abs=0.01)
    assert found.used[blocks.variables] == pytest.approx(0.25, abs=0.01)


def test_too_few_pairs_give_no_number():
    model = Ishigami()
    designs = sample(model, 64)
    blocks = blocks_of(designs)
    values = model.evaluate(designs)[0][:, 0].reshape(-1, blocks.size)
    kept = np.full(values.shape, False)
    kept[:20] = True
    assert np.isnan(by_pairs(values, kept, blocks, 64).values).all()
