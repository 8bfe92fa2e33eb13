"""Sweeps of an analytic model: their parts, effects, zeros and failures, against closed forms."""

from collections.abc import Callable

import numpy as np
import pytest

from divideropt.analysis.sweeps import Sweep, Sweeps, effects_of, sweeps_of
from divideropt.models import Domain, Outcome, Parameter, Quantity, Verdict
from divideropt.problem import DesignSpace, Evaluations, Objective, Problem, Variable

BASE = {"x": 0.25, "y": 0.7, "fixed": 4.0}
RANGES = {"x": (-1.0, 2.0), "y": (0.0, 1.0)}
POINTS = 31


class Waves:
    """line = fixed (x - y), square = x², bit = x > 0; designs with x in (1, 1.3) or y above 0.9 fail."""

    def __init__(self) -> None:
        self.parameters = {n: Parameter(n, "", n, "a number", 0.0, Domain()) for n in BASE}
        self.quantities = {
            "line": Quantity("line", "m", "l", "", 1.0, signed=True),
            "square": Quantity("square", "", "", "", 1.0),
            "bit": Quantity("bit", "", "", "", 1.0, logical=True),
            "tiny": Quantity("tiny", "", "", "zero at the campaign's own design", 2.0),
            "never": Quantity("never", "", "", "", 1.0),
        }

    def evaluate(self, designs):
        x, y, fixed = designs.T
        never = np.full(len(x), np.nan)
        quantities = np.column_stack([fixed * (x - y), x**2, x > 0, x - BASE["x"], never])
        failed = ((x > 1.0) & (x < 1.3)) | (y > 0.9)
        return quantities, [
            Verdict(Outcome.UNSTABLE, f"at {v:.1f}") if f else OK for v, f in zip(x, failed, strict=True)
        ]


OK = Verdict(Outcome.OK)


def problem(ranges=None) -> Problem:
    model = Waves()
    variables = [Variable(model.parameters[n], *bounds) for n, bounds in (ranges or RANGES).items()]
    return Problem(model, BASE, DesignSpace(tuple(variables)), (Objective(model.quantities["square"]),))


def sweeps(of: Problem, points: int = POINTS) -> Evaluations:
    """What a study asks for, in its order."""
    rows = []
    for place, variable in enumerate(of.space.variables):
        designs = np.tile([of.fixed[name] for name in of.space.names], (points, 1))
        designs[:, place] = np.linspace(variable.lower, variable.upper, points)
        rows.append(of.simulate(designs))
    return Evaluations.together(rows)


@pytest.fixture(scope="module")
def study() -> Sweeps:
    return sweeps_of(sweeps(problem()), problem(), POINTS)


@pytest.fixture
def sweep() -> Callable[..., Sweep]:
    """`sweep(values, failing)`: a quantity q over 0, 1, 2, …"""

    def make(values, failing=()) -> Sweep:
        verdicts = [Verdict(Outcome.UNSTABLE) if i in failing else OK for i in range(len(values))]
        return Sweep("x", 0.0, np.arange(len(values), dtype=float), {"q": np.array(values, dtype=float)}, verdicts)

    return make


def test_each_sweep_has_its_parameter_and_every_quantity(study):
    assert [sweep.parameter for sweep in study.sweeps] == ["x", "y"]
    for sweep in study.sweeps:
        np.testing.assert_array_equal(sweep.values, np.linspace(*RANGES[sweep.parameter], POINTS))
        assert sweep.base == BASE[sweep.parameter]
        assert list(sweep.quantities) == list(problem().model.quantities)
    x, y = study.sweeps
    np.testing.assert_allclose(x.quantities["line"], 4.0 * (x.values - 0.7), atol=1e-15)
    np.testing.assert_allclose(y.quantities["line"], 4.0 * (0.25 - y.values), atol=1e-15)


def test_a_sweep_that_is_not_whole_is_left_out(study):
    evaluations = sweeps(problem())
    found = sweeps_of(evaluations.part(0, POINTS + 5), problem(), POINTS)
    assert [sweep.parameter for sweep in found.sweeps] == ["x"]
    assert sweeps_of(evaluations.part(0, 0), problem(), POINTS).sweeps == ()


def test_what_is_no_sweep_is_refused():
    evaluations = sweeps(problem())
    with pytest.raises(ValueError, match="batch 0 of the log does not vary x alone"):
        sweeps_of(evaluations.part(1, len(evaluations)), problem(), POINTS)
    backwards = Evaluations(evaluations.designs[::-1], evaluations.quantities, evaluations.verdicts)
    with pytest.raises(ValueError, match="does not vary x alone, and rising"):
        sweeps_of(backwards, problem(), POINTS)


def test_the_base_is_the_campaigns_own_design(study):
    # 0.7 is a value of y's sweep, while 0.25 lies between two of x's, where the square would be off.
    assert study.base["square"] == BASE["x"] ** 2
    assert study.base["line"] == pytest.approx(4.0 * (BASE["x"] - BASE["y"]), rel=1e-14)


def test_the_base_between_two_designs_is_on_a_straight_line():
    alone = problem({"x": RANGES["x"]})
    base = sweeps_of(sweeps(alone), alone, POINTS).base
    assert base["line"] == pytest.approx(4.0 * (0.25 - 0.7), rel=1e-12)
    assert base["square"] == pytest.approx((0.2**2 + 0.3**2) / 2, rel=1e-12)


def test_there_is_no_base_where_it_fails_or_lies_outside_every_range():
    outside = problem({"x": (0.5, 2.0)})
    assert np.isnan(sweeps_of(sweeps(outside), outside, POINTS).base["line"])
    failing = Problem(outside.model, BASE | {"x": 1.15}, problem().space, problem().objectives)
    assert np.isnan(sweeps_of(sweeps(failing), failing, POINTS).base["square"])


def test_effects_are_ranges_over_the_base_value(study):
    x, y = (effects_of(sweep, study.base, problem().model.quantities) for sweep in study.sweeps)
    found = {effect.quantity: effect for effect in x}
    assert "bit" not in found
    assert (found["line"].least, found["line"].greatest) == pytest.approx((-6.8, 5.2))
    assert found["line"].relative == pytest.approx(12.0 / 1.8)
    assert found["square"].relative == pytest.approx(4.0 / 0.0625, rel=1e-3), "its least value is 0"
    assert [effect.quantity for effect in x] == ["tiny", "square", "line", "never"], "the most moved first"
    assert {effect.quantity: effect.relative for effect in y}["square"] == 0.0


def test_a_base_of_nothing_divides_by_a_hundredth_of_the_scale(study):
    tiny = next(
        e for e in effects_of(study.sweeps[0], study.base, problem().model.quantities) if e.quantity == "tiny"
    )
    assert tiny.relative == pytest.approx(3.0 / 0.02)


def test_failed_designs_have_no_part_in_effects(study):
    y = {effect.quantity: effect for effect in effects_of(study.sweeps[1], study.base, problem().model.quantities)}
    assert y["line"].least == pytest.approx(4.0 * (0.25 - 0.9))


def test_what_is_not_known_is_nan_and_last(study):
    last = effects_of(study.sweeps[0], study.base, problem().model.quantities)[-1]
    assert last.quantity == "never"
    assert np.isnan([last.least, last.greatest, last.relative]).all()


def test_failures_say_where_how_many_and_what(study):
    x, y = study.sweeps
    (stretch,) = x.failures()
    assert (stretch.begin, stretch.end) == pytest.approx((1.1, 1.2))
    assert (stretch.count, stretch.outcomes, stretch.example) == (2, {"unstable": 2}, "at 1.1")
    assert x.failed == 2
    assert [f.count for f in y.failures()] == [3]


def test_stretches_of_failures_are_kept_apart(sweep):
    found = sweep([1.0] * 7, failing=(0, 3, 4, 6)).failures()
    assert [(f.begin, f.end) for f in found] == [(0.0, 0.0), (3.0, 4.0), (6.0, 6.0)]


def test_a_straight_line_crosses_zero_where_it_does(study):
    assert study.sweeps[0].crossings("line") == pytest.approx((0.7,))
    assert study.sweeps[1].crossings("line") == pytest.approx((0.25,))
    assert study.sweeps[0].crossings("square") == ()


@pytest.mark.parametrize(
    ("values", "failing", "expected"),
    [
        ([-1.0, 3.0, 1.0, -1.0], (), (0.25, 2.5)),
        ([-1.0, 0.0, 2.0], (), (1.0,)),
        ([-1.0, 0.0, 0.0, 2.0], (), (1.0,)),
        ([1.0, 0.0, 2.0], (), ()),
        ([0.0, 0.0, 2.0], (), ()),
        ([0.0, 0.0], (), ()),
        ([-1.0, 5.0, 1.0], (1,), ()),
        ([-1.0, np.nan, 1.0], (), ()),
    ],
)
def test_crossings(sweep, values, failing, expected):
    assert sweep(values, failing).crossings("q") == pytest.approx(expected)
