"""The methods of optimisation, by the names a campaign gives them."""

from collections.abc import Mapping
from types import MappingProxyType

from divideropt.strategies.base import Evaluate, Strategy
from divideropt.strategies.complex_method import ComplexMethod
from divideropt.strategies.directions import reference_directions
from divideropt.strategies.genetic import Genetic
from divideropt.strategies.goal_attainment import GoalAttainment
from divideropt.strategies.memetic import Memetic
from divideropt.strategies.nsga2 import NSGA2
from divideropt.strategies.nsga3 import NSGA3
from divideropt.strategies.sms_emoa import SMSEMOA

STRATEGIES: Mapping[str, type[Strategy]] = MappingProxyType(
    {
        "nsga2": NSGA2,
        "nsga3": NSGA3,
        "sms_emoa": SMSEMOA,
        "genetic": Genetic,
        "complex": ComplexMethod,
        "goal_attainment": GoalAttainment,
        "memetic": Memetic,
    }
)

__all__ = [
    "NSGA2",
    "NSGA3",
    "SMSEMOA",
    "STRATEGIES",
    "ComplexMethod",
    "Evaluate",
    "Genetic",
    "GoalAttainment",
    "Memetic",
    "Strategy",
    "reference_directions",
]
