import numpy as np
import pytest

from divideropt.models import Outcome, Verifiable
from divideropt.models.base import Threaded
from divideropt.models.distributions import Normal, Uniform
from divideropt.models.divider import Divider
from divideropt.models.statistic import Statistic
from divideropt.models.uncertain import MOST_ROWS, Source, Uncertain, under_uncertainty
from divideropt.models.viscosity import THESIS_OIL
from divideropt.problem import simulate
from toy_model import CheckedToy, Toy

X2 = Source("x2", Uniform(0.0, 1.0))
NEEDED = (Statistic("f2", "p95"), Statistic("spare", "p5", least=True))
SHOWN = (Statistic("f2", "mean"), Statistic("f2", "p50"))


class Counting(Toy):
    """Remembers the designs it was asked for, and breaks down where x3 is above a limit."""

    def __init__(self, breaking_above=2.0, **options):
        super().__init__(**options)
        self.batches = []
        self.breaking_above = breaking_above

    def evaluate(self, designs):
        if (designs[:, 2] > self.breaking_above).any():
            raise RuntimeError("x3 is too much")
        self.batches.append(designs.copy())
        return super().evaluate(designs)


def made(model=None, sources=(X2,), samples=64, seed=1, needed=NEEDED, shown=SHOWN):
    return under_uncertainty(model or Counting(), sources, samples, seed, needed, shown)


def designs(count=7, seed=0):
    return np.random.default_rng(seed).uniform(0.1, 1.0, size=(count, 3))


def columns(model, found):
    return dict(zip(model.quantities, found[0].T, strict=True))


def test_statistics_are_those_of_the_samples_simulated_one_by_one():
    toy = Toy(failing_below=-1.0)
    model = made(toy, (X2, Source("x3", Normal(0.5, 0.1))))
    X = designs()
    found = columns(model, model.evaluate(X))
    assert list(found) == ["f1", "f2", "spare", "mean.f2", "p50.f2", "p95.f2", "p5.spare", "failed_share"]
    plain, _ = toy.evaluate(X)
    for i, name in enumerate(toy.quantities):
        np.testing.assert_array_equal(found[name], plain[:, i])
    for i, design in enumerate(X):
        samples = np.tile(design, (64, 1))
        samples[:, 1] = model.sample[:, 0]
        samples[:, 2] = Normal(0.5, 0.1).quantiles(model.sample[:, 1])
        values, _ = toy.evaluate(samples)
        size = np.abs(values[:, 1])  # f2 is signed
        assert found["p95.f2"][i] == pytest.approx(np.percentile(size, 95), rel=1e-14)
        assert found["p50.f2"][i] == pytest.approx(np.percentile(size, 50), rel=1e-14)
        assert found["mean.f2"][i] == pytest.approx(size.mean(), rel=1e-14)
        assert found["p5.spare"][i] == pytest.approx(np.percentile(values[:, 2], 5), rel=1e-14)
    np.testing.assert_array_equal(found["failed_share"], 0.0)


def test_every_design_sees_the_same_sample_and_the_cost_is_linear():
    for samples in (2, 16, 50):
        toy = Counting()
        made(toy, samples=samples).evaluate(designs(9))
        (rows,) = toy.batches
        assert len(rows) == 9 * (1 + samples)
        by_design = rows.reshape(9, 1 + samples, 3)
        assert (by_design[:, 1:, 1] == by_design[0, 1:, 1]).all()
        assert (by_design[:, :, 0] == by_design[:, :1, 0]).all()
        np.testing.assert_array_equal(by_design[:, 0], designs(9))


def test_the_sample_is_spread_evenly_hangs_on_the_seed_and_a_larger_one_begins_with_it():
    sources = (X2, Source("x3", Uniform(0.0, 1.0)))
    sample = made(sources=sources).sample
    for column in sample.T:
        assert sorted(np.floor(column * 64)) == list(range(64))
    np.testing.assert_array_equal(sample, made(sources=sources).sample)
    np.testing.assert_array_equal(sample, made(sources=sources[::-1]).sample)
    assert not np.array_equal(sample, made(sources=sources, seed=2).sample)
    np.testing.assert_array_equal(sample[:50], made(sources=sources, samples=50).sample)
    np.testing.assert_array_equal(sample, made(sources=sources, samples=100).sample[:64])


def test_results_do_not_depend_on_the_batch():
    toy = Toy(failing_below=0.1)
    model, X = made(toy, samples=33), designs(20)
    whole, verdicts = model.evaluate(X)
    again = [model.evaluate(X[i : i + k]) for i, k in ((0, 1), (1, 6), (7, 13))]
    assert whole.tobytes() == np.concatenate([q for q, _ in again]).tobytes()
    assert verdicts == [v for _, part in again for v in part]
    turned, _ = model.evaluate(X[::-1])
    assert whole.tobytes() == turned[::-1].tobytes()


def test_a_large_batch_is_simulated_in_parts():
    toy = Counting()
    count = MOST_ROWS // 65 * 2 + 5
    found, verdicts = made(toy).evaluate(designs(count))
    assert len(found) == len(verdicts) == count
    assert [len(b) for b in toy.batches] == [MOST_ROWS // 65 * 65] * 2 + [5 * 65]
    empty, none = made(toy).evaluate(designs(0))
    assert (empty.shape, none) == ((0, 8), [])


def test_a_percentile_among_the_failed_is_lost_and_with_it_the_design():
    model = made(Toy(failing_below=0.2))  # 12 or 13 of 64 samples
    X = np.array([[0.5, 0.9, 0.3]])
    values, (verdict,) = model.evaluate(X)
    found = columns(model, (values, None))
    failing = int((model.sample[:, 0] < 0.2).sum())
    assert np.isnan(found["p95.f2"][0])
    assert np.isfinite(found["p50.f2"][0])
    assert found["failed_share"][0] == 100.0 * failing / 64
    assert verdict.outcome is Outcome.UNSETTLED
    assert verdict.text == f"in {failing} of 64 samples: x2 is too small"
    assert np.isfinite(found["f2"][0])  # the design as it is has its values


def test_a_statistic_that_nothing_needs_may_be_lost():
    model = made(Toy(failing_below=0.2), needed=(Statistic("f2", "p50"),), shown=(Statistic("f2", "p95"),))
    values, (verdict,) = model.evaluate(np.array([[0.5, 0.9, 0.3]]))
    assert verdict.ok
    assert np.isnan(columns(model, (values, None))["p95.f2"][0])


def test_few_failed_samples_count_as_the_largest():
    toy = Toy(failing_below=0.03)
    model = made(toy)
    samples = np.tile([0.5, 0.9, 0.3], (64, 1))
    samples[:, 1] = model.sample[:, 0]
    values, verdicts = toy.evaluate(samples)
    size = np.abs(np.where([v.ok for v in verdicts], values[:, 1], np.inf))
    found, (verdict,) = model.evaluate(np.array([[0.5, 0.9, 0.3]]))
    assert 0 < np.isinf(size).sum() < 3
    assert verdict.ok
    assert columns(model, (found, None))["p95.f2"][0] == pytest.approx(np.percentile(size, 95), rel=1e-14)


def test_a_design_that_fails_as_it_is_has_its_own_outcome():
    _, (verdict,) = made(Toy(failing_below=0.2)).evaluate(np.array([[0.5, 0.1, 0.3]]))
    assert (verdict.outcome, verdict.text) == (Outcome.UNSETTLED, "x2 is too small")


def test_an_offset_and_a_factor_change_the_designs_own_value():
    toy = Counting()
    sources = (Source("x1", Uniform(-0.1, 0.1), "offset"), Source("x2", Uniform(0.5, 1.0), "factor"))
    model = made(toy, sources, samples=16)
    X = designs(4) * 0.8
    model.evaluate(X)
    rows = toy.batches[0].reshape(4, 17, 3)
    np.testing.assert_array_equal(rows[:, 1:, 0], X[:, :1] + Uniform(-0.1, 0.1).quantiles(model.sample[:, 0]))
    np.testing.assert_array_equal(rows[:, 1:, 1], X[:, 1:2] * Uniform(0.5, 1.0).quantiles(model.sample[:, 1]))
    np.testing.assert_array_equal(rows[:, 1:, 2], np.repeat(X[:, 2:], 16, axis=1))


def test_a_sample_beyond_the_domain_is_not_simulated_but_failed():
    toy = Counting()
    model = made(toy, (Source("x1", Uniform(-0.1, 0.1), "offset"),), samples=16)
    values, (verdict,) = model.evaluate(np.array([[0.05, 0.9, 0.3]]))
    assert (toy.batches[0] >= 0.0).all()
    assert columns(model, (values, None))["failed_share"][0] == 25.0  # offsets below -0.05
    assert verdict.outcome is Outcome.NOT_COMPLETED
    assert verdict.text.startswith("in 4 of 16 samples: x1 would be -0.0")
    assert verdict.text.endswith(", but must be at least 0 and at most 1")


def test_a_sample_on_which_the_model_breaks_down_is_failed_alone():
    sources = (Source("x3", Uniform(0.0, 1.0)),)
    model = made(Counting(breaking_above=0.99), sources)
    fixed = {"x1": 0.5, "x2": 0.9, "x3": 0.3}
    values, (verdict,) = simulate(model, fixed, ["x1"], np.array([[0.5]]))
    assert verdict.ok
    assert columns(model, (values, None))["failed_share"][0] == 100.0 / 64
    model = made(Counting(breaking_above=0.5), sources)
    _, (verdict,) = simulate(model, fixed, ["x1"], np.array([[0.5]]))
    assert verdict.outcome is Outcome.CRASHED
    assert verdict.text == "in 32 of 64 samples: the model broke down: RuntimeError: x3 is too much"


def test_it_offers_a_reference_and_threads_where_its_model_does():
    assert not isinstance(made(Toy()), Verifiable)
    checked = made(CheckedToy())
    assert isinstance(checked, Verifiable)
    reference = checked.reference()
    assert list(reference.quantities) == list(checked.quantities)
    ours, exact = columns(checked, checked.evaluate(designs())), columns(reference, reference.evaluate(designs()))
    np.testing.assert_allclose(exact["p50.f2"], ours["p50.f2"] * (1 + 1e-4), rtol=1e-12)
    assert made(Toy()).on_threads(2) is None
    assert isinstance(made(Toy()), Threaded)


def test_the_valve_under_uncertainty_is_the_same_on_threads(box_designs):
    sources = (
        Source("kinematic_viscosity", Uniform(25.0, 60.0), oil=THESIS_OIL),
        Source("coulomb_friction", Uniform(0.0, 10.0)),
    )
    model = under_uncertainty(Divider(), sources, 8, 1, [Statistic("dynamic_error", "p95")])
    assert isinstance(model, Uncertain)
    X = np.array([list(p.values()) for p in box_designs(6)])
    values, verdicts = model.evaluate(X)
    shared = model.on_threads(2)
    assert shared.model.threads == 2
    again, others = shared.evaluate(X)
    assert values.tobytes() == again.tobytes()
    assert verdicts == others
    plain, _ = Divider().evaluate(X)
    assert values[:, : plain.shape[1]].tobytes() == plain.tobytes()
    rows = model._rows(X)
    place = list(model.parameters).index("kinematic_viscosity")
    assert ((rows[:, 1:, place] > 15e-6) & (rows[:, 1:, place] < 66e-6)).all()
