"""What can be said of a store's evaluations: fronts, indicators."""

from divideropt.analysis.differences import neighbours
from divideropt.analysis.fronts import combined_front, nondominated
from divideropt.analysis.indicators import best_attainment, hypervolume, hypervolume_history
from divideropt.analysis.optimality import Optimality, optimality
from divideropt.analysis.stationary import Convergence, Kkt, converged, convergence, measured, residuals, scales_of
from divideropt.analysis.summary import Summary, repeatable, summarise
from divideropt.analysis.verification import Tally, Verified, marked, tally, worth_verifying

__all__ = [
    "Convergence",
    "Kkt",
    "Optimality",
    "Summary",
    "Tally",
    "Verified",
    "best_attainment",
    "combined_front",
    "converged",
    "convergence",
    "hypervolume",
    "hypervolume_history",
    "marked",
    "measured",
    "neighbours",
    "nondominated",
    "optimality",
    "repeatable",
    "residuals",
    "scales_of",
    "summarise",
    "tally",
    "worth_verifying",
]
