"""NSGA-II against pymoo's own, generation by generation, to the bit."""

import dataclasses

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2 as PymooNSGA2  # noqa: N811
from pymoo.core.evaluator import Evaluator
from pymoo.core.problem import Problem as PymooProblem
from pymoo.core.termination import NoTermination
from pymoo.problems.static import StaticProblem

from divideropt.problem import DesignSpace, Told, Variable
from divideropt.strategies import NSGA2
from toy_model import toy_problem


def conflict(designs):
    """Three objectives, a band that is infeasible, and a failure constraint."""
    x, y, z = designs.T
    F = np.column_stack([x, (1.0 + y) * (1.0 - x) ** 2 + z, (y - 0.5) ** 2 + np.sin(9.0 * z) ** 2])
    G = np.column_stack([np.where(y + z < 0.3, 1e9, 0.0), x + y - 1.4, 0.2 - x * z])
    return Told(F, G)


def tied(designs):
    """Two objectives and a violation in few steps, so that most comparisons are ties; many designs are infeasible."""
    x, y, z = np.round(4.0 * designs).T
    return Told(np.column_stack([x, 4.0 - x + y]), np.column_stack([z - 2.0, y - x]))


def hopeless(designs):
    """Nothing is feasible."""
    return Told(designs[:, :2], 1.0 + designs)


def ours(tell, population, generations, seed, problem):
    asked = []

    def evaluate(designs):
        asked.append(designs.copy())
        return tell(designs)

    NSGA2(population, generations).run(problem, evaluate, seed)
    return asked


def pymoos(tell, population, generations, seed, problem):
    asked = []
    sample = tell(problem.space.lower[None])
    box = PymooProblem(
        n_var=len(problem.space), n_obj=sample.F.shape[1], n_ieq_constr=sample.G.shape[1],
        xl=problem.space.lower, xu=problem.space.upper,
    )  # fmt: skip
    algorithm = PymooNSGA2(pop_size=population)
    algorithm.setup(box, seed=seed, termination=NoTermination())
    for _ in range(generations):
        infills = algorithm.ask()
        if infills is None or len(infills) == 0:
            break
        asked.append(infills.get("X"))
        told = tell(asked[-1])
        Evaluator().eval(StaticProblem(box, F=told.F, G=told.G), infills)
        algorithm.tell(infills=infills)
    return asked


def assert_same(tell, population, generations, seed, problem):
    mine, theirs = (run(tell, population, generations, seed, problem) for run in (ours, pymoos))
    assert len(mine) == len(theirs) == generations
    for one, other in zip(mine, theirs, strict=True):
        assert one.shape == other.shape
        assert one.tobytes() == other.tobytes()


@pytest.mark.parametrize("tell", [conflict, tied, hopeless])
@pytest.mark.parametrize("seed", [1, 2, 3, 71])
@pytest.mark.parametrize("population", [20, 27])
def test_every_generation_is_pymoos_to_the_bit(tell, seed, population):
    assert_same(tell, population, 25, seed, toy_problem())


def test_it_is_so_with_the_population_of_a_campaign():
    assert_same(conflict, 100, 40, 1, toy_problem())


def test_it_is_so_with_a_variable_whose_children_are_often_duplicates():
    """A box one part in 10^15 wide holds few numbers, so that matings are repeated."""
    parameter = toy_problem().model.parameters["x1"]
    narrow = DesignSpace(tuple(Variable(parameter, 1.0, 1.0 + 4e-16 * 2**i) for i in range(3)))
    problem = dataclasses.replace(toy_problem(), space=narrow)
    mine, theirs = (run(hopeless, 30, 12, 5, problem) for run in (ours, pymoos))
    assert [m.tobytes() for m in mine] == [t.tobytes() for t in theirs]
    assert any(len(m) < 30 for m in mine)


def test_a_variable_of_tiny_numbers_is_searched_as_any_other():
    """A permeability in m^2, say: pymoo takes designs that are closer than 1e-16 for one, whatever their unit."""
    parameter = toy_problem().model.parameters["x1"]
    tiny = DesignSpace((Variable(parameter, 1e-17, 1e-15), Variable(parameter, 0.0, 1e-50)))
    problem = dataclasses.replace(toy_problem(), space=tiny)
    asked = ours(lambda designs: Told(designs, np.zeros((len(designs), 1))), 20, 5, 1, problem)
    assert [len(np.unique(designs, axis=0)) for designs in asked] == [20] * 5
