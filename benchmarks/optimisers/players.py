"""Who plays, and with which settings: the one place where they stand."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType
from typing import Any

from divideropt.errors import UsageError
from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.strategies import STRATEGIES, Evaluate

from .interview import Interview

UNENDING = 10**9
"""The budget of our strategies, none of which decides by it: the recorder ends every run."""

OURS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "memetic": {"evaluations": UNENDING},
        "nsga3": {"population": 100, "generations": UNENDING, "directions": 91},
        "sms_emoa": {"population": 100, "generations": UNENDING},
        "goal_attainment": {"directions": 91, "evaluations": UNENDING},
        "nsga2": {"population": 100, "generations": UNENDING},
    }
)
"""Our strategies with their options, the champion first: that which is tested against all others. One that
`STRATEGIES` does not have is left out."""

PLAIN = "nsga2"
"""The strategy that the valve's figures are compared with, at `PLAIN_EVALUATIONS`."""

PLAIN_EVALUATIONS = 120_000


@dataclass(frozen=True)
class Player:
    """A method of optimisation.

    Attributes:
        name: In tables and files.
        ours: Whether it is a strategy of this package.
        most: Evaluations at which it stops, where it is too slow for more; else None.
        everywhere: Whether it plays the test problems, too, or the valve alone, since it is slow.
    """

    name: str
    ours: bool
    most: int | None = None
    everywhere: bool = True

    @property
    def settings(self) -> str:
        """Its settings in words; a run made with others is made again."""
        if not self.ours:
            return str(_peer(self.name).__doc__).strip().rstrip(".")
        options = {key: value for key, value in OURS[self.name].items() if value != UNENDING}
        return ", ".join(f"{key} {value}" for key, value in options.items()) or "its defaults"

    def play(self, problem: Problem, evaluate: Evaluate, seed: int, scale: FloatArray) -> None:
        """Optimise until the recorder ends it.

        Args:
            problem: What is optimised.
            evaluate: The recorder.
            seed: Seeds every draw.
            scale: Of the objectives, as a peer is told them, shape (k,).
        """
        if self.ours:
            _strategy(self.name).run(problem, evaluate, seed)
        else:
            _peer(self.name)(Interview(problem, evaluate, scale), seed)


def players() -> dict[str, Player]:
    """List who plays, our champion first, then our others, then the peers."""
    ours = [Player(name, True) for name in OURS if name in STRATEGIES]
    peers = [Player(name, False, most, name not in _VALVE_ALONE) for name, (_, _, most) in _PEERS.items()]
    return {player.name: player for player in (*ours, *peers)}


_PEERS: Mapping[str, tuple[str, str, int | None]] = MappingProxyType(
    {
        "pymoo NSGA-II": ("by_pymoo", "nsga2", None),
        "pygmo NSGA-II": ("by_pygmo", "nsga2", None),
        "pygmo MOEA/D": ("by_pygmo", "moead", None),
        "Platypus NSGA-II": ("by_platypus", "nsga2", None),
        "Platypus NSGA-III": ("by_platypus", "nsga3", None),
        "jMetalPy NSGA-II": ("by_jmetal", "nsga2", None),
        "Optuna NSGA-II": ("by_optuna", "nsga2", 200),
        "Optuna TPE": ("by_optuna", "tpe", 200),
    }
)
"""Module, function, and the most evaluations. The settings are the function's docstring."""


_VALVE_ALONE = ("Platypus NSGA-III", "Optuna TPE")


def _strategy(name: str) -> Any:
    return STRATEGIES[name](**OURS[name])


def _peer(name: str) -> Any:
    module, function, _ = _PEERS[name]
    try:
        return getattr(import_module(f"{__package__}.{module}"), function)
    except ModuleNotFoundError as missing:
        raise UsageError(
            f"{name} cannot play, since the package {missing.name} is not installed: pip install 'divideropt[bench]'"
        ) from missing
