import numpy as np
import pytest

from divideropt.problem import Told, merit
from divideropt.strategies import GoalAttainment, goal_attainment, reference_directions
from divideropt.strategies.archive import Archive
from divideropt.strategies.directions import SMALLEST_WEIGHT
from toy_model import toy_problem


def test_the_sweep_solves_the_problem_of_each_direction():
    problem, told = toy_problem(), []

    def evaluate(designs):
        told.append(problem.tell(problem.simulate(designs)))
        return told[-1]

    GoalAttainment(directions=11, evaluations=1500).run(problem, evaluate, seed=1)
    F = np.concatenate([t.F[t.feasible] for t in told])
    # The front is f2 = 1.05/(0.1 + f1), with f1 from the constraint's 0.1 to 1.
    f1 = np.linspace(0.1, 1.0, 10_001)
    front = np.column_stack([f1, 1.05 / (0.1 + f1)])
    ideal, span = front.min(axis=0), np.ptp(front, axis=0)
    for direction in reference_directions(2, 11):
        best, optimum = (((f - ideal) / span / direction).max(axis=1).min() for f in (F, front))
        if direction.min() > SMALLEST_WEIGHT:
            assert best < 1.05 * optimum
        else:  # an end of the front, where the optimum is 0
            assert best * direction.min() < 0.02


class Everything(Archive):
    """Keeps all it was told, as the method is defined."""

    def settle(self):
        self.X = np.concatenate([designs for designs, _ in self._fresh])
        self.told = Told(*(np.concatenate([getattr(t, name) for _, t in self._fresh]) for name in "FG"))

    def ideal_and_span(self):
        F = self.told.F[self.told.feasible] if self.told.feasible.any() else self.told.F
        dominated = [((f >= F).all(axis=1) & (f > F).any(axis=1)).any() for f in F]
        front = F[~np.array(dominated)]
        span = np.ptp(front, axis=0)
        return front.min(axis=0), np.where(span > 0, span, 1.0)

    def nearest(self, value):
        known = merit(value(self.told.F), self.told)
        return self.X[known.argmin()], known.min()


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("limit", [0.0, 0.999, 2.0])
def test_what_the_sweep_forgets_would_have_changed_no_bit(seed, limit, monkeypatch):
    """Also where most designs are infeasible at first (0.999), or all (2)."""
    problem = toy_problem()

    def asked():
        batches = []

        def evaluate(designs):
            batches.append(designs.tobytes())
            told = problem.tell(problem.simulate(designs))
            return Told(told.F, np.maximum(told.G, (limit - designs[:, 2])[:, None]))

        GoalAttainment(directions=7, evaluations=900).run(problem, evaluate, seed)
        return batches

    few = asked()
    monkeypatch.setattr(goal_attainment, "Archive", Everything)
    assert few == asked()
