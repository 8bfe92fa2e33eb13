"""Goal-attainment problems solved along slopes, against answers found by hand and by a grid."""

import numpy as np
import pytest

from divideropt.models.base import Domain, Parameter
from divideropt.problem import DesignSpace, Told, Variable
from divideropt.strategies.archive import Scale
from divideropt.strategies.gembicki import DIFFERENCE, Goal, attain

BOX = DesignSpace(
    tuple(
        Variable(Parameter(name, "", name, "", 0.0, Domain()), 0.0, width) for name, width in (("a", 2.0), ("b", 4.0))
    )
)
SCALE = Scale(np.zeros(2), np.array([1.0, 2.0]))


class Asked:
    """Two bowls, around (0.2, 1) and (1.4, 1) of the box, in all 0.3 above 0; `a` may be held above a limit."""

    def __init__(self, limit=-1.0, fails=lambda X: np.zeros(len(X), dtype=bool)):
        self.limit, self.fails, self.X = limit, fails, []

    def __call__(self, X):
        self.X.append(X.copy())
        failed = self.fails(X)
        F = self.objectives(X)
        return Told(
            np.where(failed[:, None], 1e4, F), np.column_stack([np.where(failed, 1e9, 0.0), self.limit - X[:, 0]])
        )

    @staticmethod
    def objectives(X):
        bowls = [(X[:, 0] - a) ** 2 + (X[:, 1] - 1.0) ** 2 / 4 for a in (0.2, 1.4)]
        return np.column_stack([0.3 + bowls[0], 2 * (0.3 + bowls[1])])

    def best(self, goal):
        X = np.concatenate(self.X)
        told = self(X)
        return float(goal.of(told.F[told.feasible]).min())


def least(goal, limit=-1.0):
    a, b = np.meshgrid(np.linspace(max(0.0, limit), 2.0, 801), np.linspace(0.0, 4.0, 801))
    return float(goal.of(Asked.objectives(np.column_stack([a.ravel(), b.ravel()]))).min())


@pytest.mark.parametrize("solver", ["slsqp", "trust-constr"])
@pytest.mark.parametrize("weights", [[0.5, 0.5], [0.8, 0.2], [0.1, 0.9]])
@pytest.mark.parametrize("limit", [-1.0, 0.9])
def test_the_goal_is_attained_as_a_fine_grid_says(solver, weights, limit):
    goal, asked = Goal(np.array(weights), SCALE, 1e-3), Asked(limit)
    attain(np.array([1.9, 3.5]), goal, BOX, asked, solver)
    assert asked.best(goal) == pytest.approx(least(goal, limit), rel=2e-3)


def test_of_two_answers_with_one_gamma_the_augmented_is_better_in_the_other_objective():
    """w asks next to nothing of the second objective; ρ decides."""
    goal = Goal(np.array([1.0, 1e3]), SCALE, 0.1)
    plain = Goal(np.array([1.0, 1e3]), SCALE, 0.0)
    F = np.array([[0.5, 4.0], [0.5, 2.0]])
    assert plain.of(F)[0] == plain.of(F)[1]
    assert goal.of(F)[0] > goal.of(F)[1]


def test_no_design_is_simulated_twice_and_none_outside_the_box():
    asked = Asked()
    attain(np.array([2.0, 4.0]), Goal(np.array([0.5, 0.5]), SCALE, 1e-3), BOX, asked, "slsqp")
    X = np.concatenate(asked.X)
    assert (BOX.lower <= X).all()
    assert (BOX.upper >= X).all()
    singles = [x.tobytes() for x in asked.X if len(x) == 1]
    assert len(set(singles)) == len(singles)


def test_a_neighbour_that_fails_gives_no_slope():
    """At the edge of what can be simulated the way along it is still found."""
    edge = 0.6
    asked = Asked(fails=lambda X: X[:, 0] > edge)
    goal = Goal(np.array([0.5, 0.5]), SCALE, 1e-3)
    attain(np.array([edge - DIFFERENCE, 3.0]), goal, BOX, asked, "slsqp")
    at_start = float(goal.of(Asked.objectives(np.array([[edge - DIFFERENCE, 3.0]])))[0])
    assert asked.best(goal) < 0.7 * at_start
