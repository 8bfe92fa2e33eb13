"""The methods of optimisation, and the samplings of sensitivity studies, by the names a campaign gives them."""

from collections.abc import Mapping
from types import MappingProxyType

from divideropt.strategies.base import Evaluate, Strategy
from divideropt.strategies.complex_method import ComplexMethod
from divideropt.strategies.directions import reference_directions
from divideropt.strategies.genetic import Genetic
from divideropt.strategies.goal_attainment import GoalAttainment
from divideropt.strategies.memetic import Memetic
from divideropt.strategies.morris import Morris
from divideropt.strategies.nsga2 import NSGA2
from divideropt.strategies.nsga3 import NSGA3
from divideropt.strategies.oat import OneAtATime
from divideropt.strategies.sms_emoa import SMSEMOA
from divideropt.strategies.sobol import Sobol

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

SAMPLINGS: Mapping[str, type[Strategy]] = MappingProxyType({"oat": OneAtATime, "morris": Morris, "sobol": Sobol})
"""What a sensitivity study asks for: designs laid out beforehand, whatever comes of them."""

METHODS: Mapping[str, type[Strategy]] = MappingProxyType({**STRATEGIES, **SAMPLINGS})
"""All that a campaign's `strategies` may name."""

__all__ = [
    "METHODS",
    "NSGA2",
    "NSGA3",
    "SAMPLINGS",
    "SMSEMOA",
    "STRATEGIES",
    "ComplexMethod",
    "Evaluate",
    "Genetic",
    "GoalAttainment",
    "Memetic",
    "Morris",
    "OneAtATime",
    "Sobol",
    "Strategy",
    "reference_directions",
]
