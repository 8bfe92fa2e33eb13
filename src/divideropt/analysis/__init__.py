"""What can be said of a store's evaluations: fronts, indicators."""

from divideropt.analysis.fronts import combined_front, nondominated, run_front
from divideropt.analysis.indicators import best_attainment, hypervolume, hypervolume_history

__all__ = [
    "best_attainment",
    "combined_front",
    "hypervolume",
    "hypervolume_history",
    "nondominated",
    "run_front",
]
