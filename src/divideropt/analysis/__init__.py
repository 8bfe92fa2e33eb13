"""What can be said of a store's evaluations: fronts, indicators."""

from divideropt.analysis.fronts import combined_front, nondominated, run_front
from divideropt.analysis.indicators import best_attainment, hypervolume, hypervolume_history
from divideropt.analysis.verification import Tally, Verified, marked, tally, worth_verifying

__all__ = [
    "Tally",
    "Verified",
    "best_attainment",
    "combined_front",
    "hypervolume",
    "hypervolume_history",
    "marked",
    "nondominated",
    "run_front",
    "tally",
    "worth_verifying",
]
