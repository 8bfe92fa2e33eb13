import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from divideropt.models import Outcome, Parameter, Quantity, Verdict
from divideropt.models.base import Domain
from divideropt.problem import (
    AGGREGATES,
    Constraint,
    DesignSpace,
    Evaluations,
    Objective,
    Problem,
    Variable,
    merit,
)

OK = Verdict(Outcome.OK)
FAILED = [Verdict(outcome, "because") for outcome in Outcome if outcome is not Outcome.OK]

COST = Quantity("cost", "EUR", "C", "what it costs", 10.0)
DRIFT = Quantity("drift", "m", "d", "where it ends", 1e-3, signed=True)
LIMIT = Quantity("limit", "Pa", "p", "how hard it presses", 1e6)
SWAY = Quantity("sway", "m", "s", "how far it leans", 1e-2, signed=True)


class Recorder:
    """A model that keeps what it is asked and answers with sums of it."""

    parameters = {n: Parameter(n, "m", n, "a length", 0.5, Domain()) for n in ("a", "b", "c", "d")}  # noqa: RUF012
    quantities = {q.name: q for q in (COST, DRIFT, LIMIT, SWAY)}  # noqa: RUF012

    def __init__(self) -> None:
        self.asked: list[np.ndarray] = []

    def evaluate(self, designs):
        self.asked.append(designs)
        columns = [designs.sum(axis=1), -designs[:, 0], designs[:, 1], designs[:, 2]]
        return np.column_stack(columns), [OK] * len(designs)


OBJECTIVES = Objective(COST), Objective(DRIFT)


def problem(*constraints: Constraint, objectives: tuple[Objective, ...] = OBJECTIVES) -> Problem:
    model = Recorder()
    space = DesignSpace(tuple(Variable(model.parameters[n], 0.0, 1.0) for n in ("d", "b")))
    return Problem(model, {"a": 1.0, "b": 2.0, "c": 3.0, "d": 4.0}, space, objectives, constraints)


def evaluations(*rows: tuple[float, float, float, float], verdicts=None) -> Evaluations:
    return Evaluations(np.zeros((len(rows), 2)), np.array(rows, dtype=float), verdicts or [OK] * len(rows))


ANY = st.floats(allow_nan=True, allow_infinity=True)
ROWS = st.lists(st.tuples(st.tuples(ANY, ANY, ANY, ANY), st.sampled_from([OK, *FAILED])), min_size=1, max_size=8)
BOUND = st.none() | st.floats(-1e9, 1e9)
CONSTRAINTS = st.lists(
    st.tuples(st.sampled_from([COST, DRIFT, LIMIT, SWAY]), BOUND, BOUND)
    .filter(lambda drawn: drawn[1:] != (None, None))
    .map(lambda drawn: Constraint(*drawn)),
    max_size=4,
)


@given(ROWS, CONSTRAINTS)
@pytest.mark.filterwarnings("ignore:overflow encountered")  # of numbers beyond any physics
def test_what_is_told_is_always_finite(rows, constraints) -> None:
    asked = problem(*constraints)
    told = asked.tell(evaluations(*(r for r, _ in rows), verdicts=[v for _, v in rows]))
    assert told.F.shape == (len(rows), 2)
    assert told.G.shape == (len(rows), asked.constraint_count)
    assert np.isfinite(told.F).all()
    assert np.isfinite(told.G).all()
    assert np.isfinite(told.violation).all()
    assert (told.violation >= 0).all()


@given(ROWS, CONSTRAINTS)
@pytest.mark.filterwarnings("ignore:overflow encountered")
def test_a_failed_design_is_worse_than_any_that_is_not(rows, constraints) -> None:
    told = problem(*constraints).tell(evaluations(*(r for r, _ in rows), verdicts=[v for _, v in rows]))
    failed = np.array([not v.ok or not np.isfinite(r[:2]).all() for r, v in rows])
    assert (told.G[failed, 0] > 0).all()
    assert (told.G[~failed, 0] == 0).all()
    assert not told.feasible[failed].any()
    if failed.any() and not failed.all():
        assert told.violation[failed].min() > told.violation[~failed].max()
        assert merit(told.F[:, 0], told)[failed].min() > merit(np.zeros(len(rows)), told)[~failed].max()


@pytest.mark.parametrize("verdict", FAILED, ids=lambda v: v.outcome.value)
def test_no_outcome_but_ok_is_feasible(verdict) -> None:
    told = problem().tell(evaluations((1.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), verdicts=[OK, verdict]))
    assert told.feasible.tolist() == [True, False]


def test_a_failed_designs_own_numbers_are_not_told() -> None:
    # A jammed spool can score better than any working valve; it must not be heard.
    told = problem().tell(evaluations((1e-9, 1e-9, 0, 0), (50.0, 2e-3, 0, 0), verdicts=[FAILED[0], OK]))
    assert (told.F[0] > told.F[1]).all()
    np.testing.assert_array_equal(told.F[1], [50.0, 2e-3])


def test_an_objective_that_is_not_defined_fails_the_design() -> None:
    told = problem().tell(evaluations((np.nan, 0, 0, 0), (0, np.inf, 0, 0), (0, 0, np.nan, np.nan)))
    assert told.feasible.tolist() == [False, False, True]


def test_a_constraint_that_is_not_defined_is_violated() -> None:
    told = problem(Constraint(LIMIT, maximum=1e6), Constraint(SWAY, 0.0, 1.0)).tell(
        evaluations((0, 0, np.nan, 0.5), (0, 0, 0, np.nan), (0, 0, 0, 0.5))
    )
    assert told.feasible.tolist() == [False, False, True]
    assert told.violation[0] > 0
    assert told.violation[1] > 0


@pytest.mark.parametrize("bound", [-3e6, -1e-9, 0.0, 1e-9, 30e6])
def test_bounds_are_inclusive(bound) -> None:
    below, above = np.nextafter(bound, -np.inf), np.nextafter(bound, np.inf)
    if bound == 0.0:  # divided by the scale, the very next number is none
        below, above = -1e-300, 1e-300
    rows = evaluations((0, 0, below, 0), (0, 0, bound, 0), (0, 0, above, 0))
    assert problem(Constraint(LIMIT, maximum=bound)).tell(rows).feasible.tolist() == [True, True, False]
    assert problem(Constraint(LIMIT, minimum=bound)).tell(rows).feasible.tolist() == [False, True, True]
    assert problem(Constraint(LIMIT, bound, bound)).tell(rows).feasible.tolist() == [False, True, False]


@pytest.mark.parametrize(
    ("constraint", "value", "violations"),
    [
        (Constraint(LIMIT, maximum=30e6), 33e6, [0.1]),  # over the bound, divided by it
        (Constraint(LIMIT, maximum=30e6), 15e6, [-0.5]),
        (Constraint(LIMIT, minimum=2e6), 1e6, [0.5]),
        (Constraint(LIMIT, 2e6, 4e6), 5e6, [-1.5, 0.25]),  # a column a bound: the minimum's first
        (Constraint(LIMIT, minimum=-2e6), -3e6, [0.5]),  # by the magnitude of a negative bound
        (Constraint(LIMIT, minimum=0.0), -3e6, [3.0]),  # by the scale where the bound is 0
        (Constraint(LIMIT, maximum=0.0), 0.5e6, [0.5]),
        (Constraint(SWAY, maximum=0.2), -0.3, [0.5]),  # a signed quantity by its magnitude
        (Constraint(SWAY, maximum=0.2), 0.3, [0.5]),
        (Constraint(SWAY, minimum=0.2), -0.3, [-0.5]),
        (Constraint(SWAY, minimum=0.2), -0.1, [0.5]),
        (Constraint(SWAY, maximum=0.0), -0.03, [3.0]),
    ],
)
def test_a_violation_is_relative(constraint, value, violations) -> None:
    column = value if constraint.quantity is LIMIT else 0.0, value if constraint.quantity is SWAY else 0.0
    told = problem(constraint).tell(evaluations((0, 0, *column)))
    np.testing.assert_allclose(told.G, [[0.0, *violations]], rtol=1e-12)
    assert told.violation[0] == pytest.approx(sum(max(v, 0.0) for v in violations))


def test_violations_of_several_constraints_add_up() -> None:
    constraints = Constraint(LIMIT, maximum=1e6), Constraint(SWAY, maximum=0.1), Constraint(COST, maximum=100.0)
    asked = problem(*constraints)
    told = asked.tell(evaluations((50.0, 0, 1.5e6, -0.2)))
    np.testing.assert_allclose(told.G, [[0.0, 0.5, 1.0, -0.5]])
    assert told.violation[0] == pytest.approx(1.5)
    assert asked.constraint_count == 4


@given(st.floats(-1e3, 1e3))
def test_a_signed_objective_counts_by_its_magnitude(drift) -> None:
    told = problem().tell(evaluations((-7.0, drift, 0, 0)))
    assert told.F[0, 1] == abs(drift)
    assert told.F[0, 0] == -7.0  # one that is not keeps its sign


def test_telling_leaves_the_results_as_they_are() -> None:
    rows = evaluations((np.nan, -1.0, -5e6, 2.0), (1.0, -2.0, 9e9, -3.0), verdicts=[FAILED[0], OK])
    before = rows.quantities.copy()
    asked = problem(Constraint(LIMIT, 0.0, 1e6), Constraint(SWAY, maximum=1.0))
    first = asked.tell(rows)
    np.testing.assert_array_equal(rows.quantities, before)
    second = asked.tell(rows)
    np.testing.assert_array_equal(first.F, second.F)
    np.testing.assert_array_equal(first.G, second.G)


def test_each_design_is_told_by_itself() -> None:
    # A log replayed in other batches must answer the same.
    rows = [(1.0, -2.0, 3e6, 0.1), (np.nan, 0.0, 0.0, 0.0), (4.0, 5.0, np.nan, -9.0)]
    asked = problem(Constraint(LIMIT, 0.0, 1e6), Constraint(SWAY, maximum=1.0))
    together = asked.tell(evaluations(*rows))
    for i, row in enumerate(rows):
        alone = asked.tell(evaluations(row))
        np.testing.assert_array_equal(alone.F[0], together.F[i])
        np.testing.assert_array_equal(alone.G[0], together.G[i])


def test_variables_replace_the_fixed_parameters_by_name() -> None:
    asked = problem()
    designs = np.array([[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]])  # d, b
    found = asked.simulate(designs)
    expected = [[1.0, 0.2, 3.0, 0.1], [1.0, 0.4, 3.0, 0.3], [1.0, 0.6, 3.0, 0.5]]
    np.testing.assert_array_equal(asked.model.asked[0], expected)
    np.testing.assert_array_equal(found.designs, designs)
    assert len(found) == 3
    assert found.quantities.shape == (3, 4)
    np.testing.assert_array_equal(asked.fixed["b"], 2.0)


def test_merit_orders_feasible_by_value_and_others_by_violation() -> None:
    asked = problem(Constraint(LIMIT, maximum=1e6))
    rows = evaluations((0, 0, 0, 0), (0, 0, 0, 0), (0, 0, 2e6, 0), (0, 0, 9e6, 0), (0, 0, 0, 0))
    rows = Evaluations(rows.designs, rows.quantities, [OK, OK, OK, OK, FAILED[0]])
    order = merit(np.array([2.0, -1.0, -100.0, -200.0, -300.0]), asked.tell(rows))
    assert np.argsort(order).tolist() == [1, 0, 2, 3, 4]


def test_merit_puts_any_feasible_design_first() -> None:
    objectives = Objective(COST, goal=0.5, weight=3), Objective(DRIFT, goal=1.0, weight=1)
    asked = problem(Constraint(LIMIT, maximum=1e6), objectives=objectives)
    told = asked.tell(evaluations((60.0, 0, 1e6, 0), (0.1, 0, 1.001e6, 0)))
    assert told.feasible.tolist() == [True, False]
    order = merit(AGGREGATES["power_sum"](told.F, objectives), told)
    assert order[0] < order[1]


def test_space_clips_and_samples_within_its_bounds() -> None:
    model = Recorder()
    space = DesignSpace((Variable(model.parameters["a"], -1.0, 1.0), Variable(model.parameters["b"], 5.0, 5.5)))
    assert len(space) == 2
    assert space.names == ("a", "b")
    np.testing.assert_array_equal(space.clip(np.array([[-9.0, 5.2], [0.5, 9.0]])), [[-1.0, 5.2], [0.5, 5.5]])
    drawn = space.sample(500, np.random.default_rng(1))
    assert drawn.shape == (500, 2)
    assert (drawn >= space.lower).all()
    assert (drawn <= space.upper).all()
    assert (np.ptp(drawn, axis=0) > 0.95 * (space.upper - space.lower)).all()
    np.testing.assert_array_equal(drawn, space.sample(500, np.random.default_rng(1)))
