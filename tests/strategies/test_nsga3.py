"""What was mended around pymoo's NSGA-III: its tournament, its scale, and what it does to the process's warnings."""

import dataclasses
import warnings

import numpy as np
from pymoo.core.population import Population

from divideropt.models import Quantity
from divideropt.problem import Objective, Told
from divideropt.strategies import NSGA3, SMSEMOA
from divideropt.strategies.nsga3 import by_violation_then_chance
from toy_model import toy_problem
from unseeded import seeded_only


def test_a_tournament_is_won_by_less_violation_else_by_a_coin_of_the_runs_own():
    violation = np.array([0.0, 2.0, 2.0, 0.0])
    held = Population.new(X=np.zeros((4, 1)))
    for individual, value in zip(held, violation, strict=True):
        individual.CV = np.array([value])
    pairs = np.array([[0, 1], [1, 3]] + [[1, 2]] * 1000 + [[3, 0]] * 1000)
    with seeded_only():
        first, second, other = (
            by_violation_then_chance(held, pairs, random_state=np.random.default_rng(seed))[:, 0]
            for seed in (1, 1, 2)
        )
    assert first[:2].tolist() == [0, 3]
    assert first.tobytes() == second.tobytes() != other.tobytes()
    # 1,000 fair coins show between 437 and 563 heads but for one time in 15,000 (four standard deviations)
    assert 437 < (first[2:1002] == 1).sum() < 563
    assert 437 < (first[1002:] == 3).sum() < 563


def asked(strategy, unit, infeasible=0.3):
    """What a run asks for where the second objective is given in a unit of that size."""
    quantities = (Quantity("a", "", "a", "first", 1.0), Quantity("b", "", "b", "second", unit))
    problem = dataclasses.replace(toy_problem(), objectives=tuple(map(Objective, quantities)))
    batches = []

    def evaluate(designs):
        batches.append(designs.tobytes())
        x, y, _ = designs.T
        F = np.column_stack([x, unit * (1.0 + y) * (1.0 - np.sqrt(x))])
        return Told(F, np.where(y < infeasible, 1e9, 0.0)[:, None] * np.ones(problem.constraint_count))

    with seeded_only():
        strategy.run(problem, evaluate, 3)
    return batches


def test_the_unit_of_an_objective_changes_nothing():
    """A power of 2, so that no bit is lost; 1e-6 m³ is about that."""
    for strategy in (NSGA3(20, 15, directions=12), SMSEMOA(20, 15)):
        assert asked(strategy, 2.0**-20) == asked(strategy, 1.0)


def test_a_run_without_a_feasible_design_goes_on_to_its_budget():
    for strategy in (NSGA3(12, 8, directions=8), SMSEMOA(12, 8)):
        assert len(asked(strategy, 1.0, infeasible=2.0)) == 8


def test_warnings_are_as_they_were():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        before = list(warnings.filters)
        asked(NSGA3(20, 15, directions=12), 1.0)
        assert list(warnings.filters) == before
