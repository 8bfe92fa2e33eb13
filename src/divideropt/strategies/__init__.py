"""The methods of optimisation, by the names a campaign gives them."""

from collections.abc import Mapping
from types import MappingProxyType

from divideropt.strategies.base import Evaluate, Strategy
from divideropt.strategies.complex_method import ComplexMethod
from divideropt.strategies.genetic import Genetic
from divideropt.strategies.goal_attainment import GoalAttainment
from divideropt.strategies.nsga2 import NSGA2

STRATEGIES: Mapping[str, type[Strategy]] = MappingProxyType(
    {
        "nsga2": NSGA2,
        "genetic": Genetic,
        "complex": ComplexMethod,
        "goal_attainment": GoalAttainment,
    }
)

__all__ = ["NSGA2", "STRATEGIES", "ComplexMethod", "Evaluate", "Genetic", "GoalAttainment", "Strategy"]
