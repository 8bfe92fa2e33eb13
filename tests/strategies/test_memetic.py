import dataclasses

import numpy as np
import pytest

from divideropt.analysis import hypervolume
from divideropt.models import Domain, Parameter
from divideropt.problem import DesignSpace, Told, Variable
from divideropt.strategies import NSGA2, Memetic, memetic
from toy_model import toy_problem


def problem(variables, objectives, lower=0.0, upper=1.0):
    """A problem of that size, for answers of our own."""
    toy = toy_problem()
    parameters = [Parameter(f"x{i}", "", "x", "", lower, Domain(lower, upper)) for i in range(variables)]
    space = DesignSpace(tuple(Variable(p, lower, upper) for p in parameters))
    return dataclasses.replace(toy, space=space, objectives=toy.objectives[:1] * objectives, constraints=())


def feasible(F):
    return Told(F, np.zeros((len(F), 1)))


def run(strategy, where, seed, answer):
    """Run a strategy; return all designs and what was told of them."""
    asked, told = [], []

    def evaluate(designs):
        asked.append(designs.copy())
        told.append(answer(designs))
        return told[-1]

    strategy.run(where, evaluate, seed)
    return np.concatenate(asked), Told(*(np.concatenate([getattr(t, name) for t in told]) for name in "FG"))


def dtlz2(X):
    """Deb et al. (2002): the front is the octant of the unit sphere, the last variables at 0.5."""
    g = ((X[:, 2:] - 0.5) ** 2).sum(axis=1)
    a, b = X[:, 0] * np.pi / 2, X[:, 1] * np.pi / 2
    return (1 + g)[:, None] * np.column_stack([np.cos(a) * np.cos(b), np.cos(a) * np.sin(b), np.sin(a)])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_on_three_objectives_it_leaves_less_than_half_of_what_nsga2_leaves(seed):
    """What is missing of the front's hypervolume after 1,000 evaluations, the box 1.1³ less the ball's octant."""
    reference, whole = np.full(3, 1.1), 1.0 - np.pi / 6 / 1.1**3

    def missing(strategy):
        designs, told = run(strategy, problem(7, 3), seed, lambda X: feasible(dtlz2(X)))
        assert len(designs) <= 1000
        return whole - hypervolume(told.F, reference)

    memetic = missing(Memetic(population=40, evaluations=1000))
    assert 0.0 < memetic < 0.5 * missing(NSGA2(population=40, generations=25))


def test_one_objective_is_polished_too(monkeypatch):
    """To a tenth of what breeding alone leaves. All its directions are one: 16 of them do, and take less time."""
    monkeypatch.setattr(memetic, "DIRECTIONS", 16)
    bowl = np.array([0.3, 0.6, 0.5, 0.2])

    def best(strategy):
        designs, told = run(strategy, problem(4, 1), 1, lambda X: feasible(((X - bowl) ** 2).sum(axis=1)[:, None]))
        assert len(designs) <= 220
        return told.F.min()

    assert best(Memetic(population=20, evaluations=220)) < 0.1 * best(NSGA2(population=20, generations=11))


def test_a_constraint_that_cuts_the_front_is_met_and_searched_up_to():
    """Two bowls 0.6 apart; what is nearest to the second lies behind a wall half way."""

    def answer(X):
        F = np.column_stack([((X - c) ** 2).sum(axis=1) for c in ([0.2, 0.5, 0.5], [0.8, 0.5, 0.5])])
        return Told(F, np.column_stack([X[:, 0] - 0.5]))

    _, told = run(Memetic(population=20, evaluations=300), problem(3, 2), 1, answer)
    assert told.F[told.feasible].min(axis=0) == pytest.approx([0.0, 0.09], abs=5e-3)


@pytest.mark.parametrize("objectives", [1, 2])
@pytest.mark.parametrize("failed", [True, False])
def test_where_nothing_is_feasible_it_spends_its_budget_and_ends(objectives, failed):
    def answer(X):
        if failed:  # as `Problem.tell` words it
            return Told(np.full((len(X), objectives), 1e4), np.full((len(X), 1), 1e9))
        return Told(X[:, :objectives], 1.0 + X[:, :1])

    designs, told = run(Memetic(population=12, evaluations=400), problem(3, objectives), 1, answer)
    assert 388 < len(designs) <= 400
    assert not told.feasible.any()


def test_without_a_feasible_design_it_breeds_towards_less_violation():
    def answer(X):
        return Told(X[:, :2], 1.0 + X.sum(axis=1)[:, None])

    _, told = run(Memetic(population=12, evaluations=400), problem(3, 2), 1, answer)
    assert told.violation[-12:].max() < np.quantile(told.violation[:12], 0.25)


def test_it_ends_where_nothing_new_can_be_found():
    """Between 1 and 1 + 4 units in the last place lie five numbers."""
    where = problem(1, 2, lower=1.0, upper=1.0 + 4 * np.finfo(float).eps)
    strategy = Memetic(population=12, evaluations=1000)
    designs, _ = run(strategy, where, 1, lambda X: feasible(X * [[1.0, -1.0]]))
    assert len(np.unique(designs)) == len(designs) <= 5


def test_a_budget_smaller_than_the_population_is_refused_with_a_remedy():
    option, text = Memetic(population=100, evaluations=99).objection(5, 3)
    assert option == "evaluations"
    assert "99" in text
    assert "population of 100" in text
    assert "give more" in text
    assert Memetic(population=100, evaluations=100).objection(5, 3) is None


def test_a_budget_of_one_population_is_spent_on_it():
    designs, _ = run(Memetic(population=12, evaluations=12), problem(3, 2), 1, lambda X: feasible(X[:, :2]))
    assert len(designs) == 12
