"""What every strategy promises: see `divideropt.strategies.base`."""

import dataclasses

import numpy as np
import pytest

from divideropt.analysis import hypervolume
from divideropt.campaign.load import default_campaign
from divideropt.campaign.plan import build_problem
from divideropt.models import Domain, Parameter
from divideropt.problem import DesignSpace, Told, Variable
from divideropt.strategies import (
    METHODS,
    NSGA2,
    NSGA3,
    SAMPLINGS,
    SMSEMOA,
    ComplexMethod,
    Genetic,
    GoalAttainment,
    Memetic,
    Morris,
    OneAtATime,
    Sobol,
)
from divideropt.strategies.complex_moves import VARIANTS
from toy_model import toy_problem
from unseeded import seeded_only

SMALL = {
    "nsga2": (NSGA2(population=12, generations=6), NSGA2(population=12, generations=9)),
    "nsga3": (
        NSGA3(population=12, generations=6, directions=8),
        NSGA3(population=12, generations=40, directions=8),
    ),
    "sms_emoa": (SMSEMOA(population=12, generations=6), SMSEMOA(population=12, generations=9)),
    "genetic": (Genetic(population=12, generations=6), Genetic(population=12, generations=9)),
    "complex": (ComplexMethod(points=6, evaluations=70), ComplexMethod(points=6, evaluations=110)),
    **{
        f"complex {variant}": (
            ComplexMethod(variant=variant, points=6, evaluations=70),
            ComplexMethod(variant=variant, points=6, evaluations=110),
        )
        for variant in VARIANTS
    },
    **{
        f"goal_attainment {solver}": (
            GoalAttainment(directions=7, evaluations=120, solver=solver),
            GoalAttainment(directions=7, evaluations=200, solver=solver),
        )
        for solver in ("slsqp", "trust-constr")
    },
    "memetic": (Memetic(population=12, evaluations=200), Memetic(population=12, evaluations=400)),
    "goal_attainment": (
        GoalAttainment(directions=7, evaluations=120),
        GoalAttainment(directions=7, evaluations=200),
    ),
    "morris": (Morris(trajectories=20), Morris(trajectories=40)),
    "sobol": (Sobol(samples=64), Sobol(samples=128)),
    "sobol alone": (Sobol(samples=128, second_order=False), Sobol(samples=512, second_order=False)),
    "oat": (OneAtATime(points=30), OneAtATime(points=30)),
}


@pytest.fixture(autouse=True)
def _seeded_only():
    """No strategy here may draw from a generator without a seed; `test_unseeded.py` shows that this bites."""
    with seeded_only():
        yield


def batches(strategy, seed=1, answers=None):
    """Run a strategy on the toy; answer from a log as far as it goes."""
    problem, asked = toy_problem(), []

    def evaluate(designs):
        asked.append(designs.copy())
        if answers is not None and len(asked) <= len(answers):
            assert asked[-1].tobytes() == answers[len(asked) - 1].tobytes()
        return problem.tell(problem.simulate(designs))

    strategy.run(problem, evaluate, seed)
    return asked


def test_every_strategy_is_under_contract():
    assert {name.split()[0] for name in SMALL} == set(METHODS)


@pytest.fixture(params=SMALL, name="pair")
def _pair(request):
    return SMALL[request.param]


def test_one_seed_gives_the_same_batches_to_the_bit(pair):
    first, second = batches(pair[0]), batches(pair[0])
    assert [b.tobytes() for b in first] == [b.tobytes() for b in second]


def test_another_seed_gives_others(pair):
    if isinstance(pair[0], OneAtATime):
        assert batches(pair[0], seed=1)[0].tobytes() == batches(pair[0], seed=2)[0].tobytes()
        return
    assert batches(pair[0], seed=1)[0].tobytes() != batches(pair[0], seed=2)[0].tobytes()


def test_a_run_replays_from_its_log_and_goes_on(pair):
    whole = batches(pair[0])
    again = batches(pair[0], answers=whole[: len(whole) // 2])
    assert [b.tobytes() for b in again] == [b.tobytes() for b in whole]


def test_a_larger_budget_begins_with_the_smaller(pair):
    small, large = batches(pair[0]), batches(pair[1])
    assert len(large) > len(small) or pair[0] == pair[1]
    assert [b.tobytes() for b in large[: len(small)]] == [b.tobytes() for b in small]


def test_it_stays_in_the_box_and_within_its_budget(pair):
    asked = np.concatenate(batches(pair[0]))
    assert asked.shape[1] == 3
    assert np.all((asked >= 0.0) & (asked <= 1.0))
    assert 0.8 * pair[0].budget(3) <= len(asked) <= pair[0].budget(3)


@pytest.fixture(scope="module", name="valve")
def _valve():
    return build_problem(default_campaign())


def test_it_repeats_and_replays_on_the_valve_to_the_bit(pair, valve):
    def evaluations(log):
        """Run the strategy, answered from a log as far as that goes."""
        answered = []

        def evaluate(designs):
            known = log[len(answered)] if len(answered) < len(log) else None
            assert known is None or known.designs.tobytes() == designs.tobytes()
            answered.append(valve.simulate(designs.copy()) if known is None else known)
            return valve.tell(answered[-1])

        strategy = dataclasses.replace(pair[0], **({"points": 10} if hasattr(pair[0], "points") else {}))
        strategy.run(valve, evaluate, seed=7)
        return answered

    whole = evaluations([])
    for log in ([], whole[: len(whole) // 2], whole):
        again = evaluations(log)
        assert [b.designs.tobytes() for b in again] == [b.designs.tobytes() for b in whole]
        assert [b.quantities.tobytes() for b in again] == [b.quantities.tobytes() for b in whole]


@pytest.mark.parametrize("pair", [SMALL[name] for name in SMALL if name.split()[0] not in SAMPLINGS])
def test_it_beats_random_sampling(pair, request):
    if getattr(pair[1], "solver", "complex") != "complex":
        known = "a sweep along slopes covers the toy's front worse than random designs do in so few evaluations"
        request.applymarker(pytest.mark.xfail(reason=known, strict=True))
    problem = toy_problem()
    reference = np.array([1.0, 20.0])

    def volume(designs):
        told = problem.tell(problem.simulate(designs))
        return hypervolume(told.F[told.feasible], reference)

    def attained(designs):
        told = problem.tell(problem.simulate(designs))
        goals, weights = np.array([0.2, 2.0]), np.array([1.0, 2.0])
        return ((told.F[told.feasible] - goals) / goals * weights).max(axis=1).min()

    found = np.concatenate(batches(pair[1]))
    blind = problem.space.sample(len(found), np.random.default_rng(5))
    if hasattr(pair[1], "aggregate"):
        assert attained(found) < attained(blind)
    else:
        assert volume(found) > volume(blind)


@pytest.mark.parametrize("strategy", [ComplexMethod(evaluations=300), GoalAttainment(directions=3, evaluations=700)])
def test_it_goes_on_with_as_many_variables_as_the_divider_has(strategy):
    def parameter(i):
        return Parameter(f"x{i}", "", "x", "", 0.5, Domain(0.0, 1.0))

    space = DesignSpace(tuple(Variable(parameter(i), 0.0, 1.0) for i in range(28)))
    problem = dataclasses.replace(toy_problem(), space=space)
    spent = 0

    def evaluate(designs):
        nonlocal spent
        spent += len(designs)
        F = np.column_stack([(designs**2).sum(axis=1), ((designs - 1) ** 2).sum(axis=1)])
        return Told(F, np.zeros((len(designs), problem.constraint_count)))

    strategy.run(problem, evaluate, seed=1)
    assert spent > 0.9 * strategy.evaluations


def test_options_that_do_not_suit_the_problem_are_named_with_a_remedy():
    assert ComplexMethod(points=5).objection(5, 3)[0] == "points"
    assert ComplexMethod(points=10, evaluations=9).objection(5, 3)[0] == "evaluations"
    assert GoalAttainment(directions=3).objection(5, 4)[0] == "directions"
    assert NSGA3(directions=3).objection(5, 4)[0] == "directions"
    assert "give at least 91" in NSGA3(population=90).objection(5, 3)[1]
    assert NSGA3(population=91).objection(5, 3) is None
    assert "at least 50" in GoalAttainment(evaluations=49).objection(5, 3)[1]
    for strategy in (pair[0] for pair in SMALL.values()):
        assert strategy.objection(3, 2) is None
