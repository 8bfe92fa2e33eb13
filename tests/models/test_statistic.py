import numpy as np
import pytest

from divideropt.models import Quantity
from divideropt.models.statistic import Statistic, is_kind, parted, words_of

VALUES = np.random.default_rng(1).lognormal(size=(5, 37))
NONE_FAILED = np.zeros(VALUES.shape, dtype=bool)


def of(kind, values=VALUES, failed=None, least=False):
    return Statistic("q", kind, least).of(values, np.zeros(values.shape, dtype=bool) if failed is None else failed)


@pytest.mark.parametrize("percent", ["0", "5", "25", "50", "95", "99.5", "100"])
def test_percentiles_are_those_of_numpy(percent):
    np.testing.assert_allclose(of(f"p{percent}"), np.percentile(VALUES, float(percent), axis=1), rtol=1e-15)


def test_mean_and_deviation_are_those_of_numpy():
    np.testing.assert_allclose(of("mean"), VALUES.mean(axis=1), rtol=1e-13)
    np.testing.assert_allclose(of("sd"), VALUES.std(axis=1, ddof=1), rtol=1e-13)


@pytest.mark.parametrize("kind", ["mean", "sd", "p5", "p95"])
def test_a_row_does_not_depend_on_the_others(kind):
    alone = np.concatenate([of(kind, row[None]) for row in VALUES])
    strided = of(kind, np.asfortranarray(VALUES))
    assert of(kind).tobytes() == alone.tobytes() == strided.tobytes()


def test_a_failed_sample_is_worse_than_any_value():
    values = np.arange(21.0)[None]
    failed = values < 2  # the values of the two are small, and do not count
    assert of("p90", values, failed)[0] == 20.0  # the 19th of 21, the last that is finite
    assert np.isnan(of("p91", values, failed)[0])
    assert of("p5", values, failed)[0] == 3.0
    assert np.isnan(of("mean", values, failed)[0])
    assert np.isnan(of("sd", values, failed)[0])
    assert np.isnan(of("p100", values, failed)[0])


def test_for_a_lower_bound_it_is_smaller():
    values = np.arange(21.0)[None]
    failed = values > 18
    assert np.isnan(of("p5", values, failed, least=True)[0])
    assert of("p10", values, failed, least=True)[0] == 0.0
    assert of("p50", values, failed, least=True)[0] == 8.0


def test_a_value_that_is_not_defined_counts_as_failed():
    values = np.where(np.arange(21.0) == 3.0, np.nan, np.arange(21.0))[None]
    assert np.isnan(of("p100", values)[0])
    assert of("p50", values)[0] == 11.0


def test_values_beyond_all_measure_are_not_defined_either():
    assert np.isnan(of("mean", np.full((1, 3), 1e308))[0])


@pytest.mark.parametrize("word", ["mean", "sd", "p0", "p5", "p50", "p95", "p99.5", "p0.001", "p100"])
def test_what_is_a_statistic(word):
    assert is_kind(word)
    assert parted(f"{word}.worst.settling_time") == (word, "worst.settling_time")


@pytest.mark.parametrize(
    "word", ["", "p", "P95", "p05", "p95.0", "p101", "p100.5", "p-5", "p1e1", "median", 95, None]
)
def test_what_is_none(word):
    assert not is_kind(word)


def test_words():
    assert [words_of(k) for k in ("mean", "sd", "p1", "p2", "p13", "p23", "p95", "p99.5")] == [
        "mean", "standard deviation", "1st percentile", "2nd percentile", "13th percentile", "23rd percentile",
        "95th percentile", "99.5th percentile",
    ]  # fmt: skip


def test_what_a_quantity_becomes():
    signed = Quantity("gain", "m", "g", "what is gained", 2.0, signed=True)
    made = Statistic("gain", "p95").described(signed)
    assert (made.name, made.unit, made.symbol, made.scale, made.signed) == ("p95.gain", "m", "|g|", 2.0, False)
    assert made.description == "what is gained; 95th percentile of its magnitude over the samples"
