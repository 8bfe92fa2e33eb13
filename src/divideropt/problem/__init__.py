"""What is asked of a model: design space, objectives, constraints, aggregates."""

from divideropt.problem.aggregate import AGGREGATES, Aggregate
from divideropt.problem.criteria import Constraint, Objective
from divideropt.problem.problem import FAILURE_VIOLATION, Evaluations, Problem, Told, merit
from divideropt.problem.simulation import one_thread, simulate
from divideropt.problem.space import DesignSpace, Variable

__all__ = [
    "AGGREGATES",
    "FAILURE_VIOLATION",
    "Aggregate",
    "Constraint",
    "DesignSpace",
    "Evaluations",
    "Objective",
    "Problem",
    "Told",
    "Variable",
    "merit",
    "one_thread",
    "simulate",
]
