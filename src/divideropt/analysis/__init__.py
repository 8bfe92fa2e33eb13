"""What can be said of a store's evaluations: fronts, indicators."""

from divideropt.analysis.fronts import combined_front, nondominated
from divideropt.analysis.indicators import best_attainment, hypervolume, hypervolume_history
from divideropt.analysis.summary import Summary, repeatable, summarise
from divideropt.analysis.verification import Tally, Verified, marked, tally, worth_verifying

__all__ = [
    "Summary",
    "Tally",
    "Verified",
    "best_attainment",
    "combined_front",
    "hypervolume",
    "hypervolume_history",
    "marked",
    "nondominated",
    "repeatable",
    "summarise",
    "tally",
    "worth_verifying",
]
