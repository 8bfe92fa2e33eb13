"""What can be said of a store's evaluations: fronts, indicators, tests between strategies, choices."""

from divideropt.analysis.attainment import attainment_surface, median_surface, worst_surface
from divideropt.analysis.choice import Choice, choose
from divideropt.analysis.comparison import INDICATORS, Comparison, Contender, Indicator, Ranking, Score, compare
from divideropt.analysis.course import Course, course_of
from divideropt.analysis.decision import Goals, achievement, bulge, knee_points, meeting_goals, pseudo_weights
from divideropt.analysis.differences import neighbours
from divideropt.analysis.fronts import combined_front, nondominated
from divideropt.analysis.goal_directions import gaps, reached
from divideropt.analysis.house_of_quality import Criterion, House, house_of_quality
from divideropt.analysis.indicators import (
    additive_epsilon,
    attainment_history,
    best_attainment,
    hypervolume,
    hypervolume_contributions,
    hypervolume_history,
    igd_plus,
    multiplicative_epsilon,
)
from divideropt.analysis.morris import MorrisStudy, morris_study
from divideropt.analysis.optimality import Optimality, optimality
from divideropt.analysis.ranking import PairTest, effect_size, holm, pair_tests, probability_above, several_test
from divideropt.analysis.scale import Scale, region
from divideropt.analysis.sobol import SobolStudy, sobol_study
from divideropt.analysis.spread import representatives, spread
from divideropt.analysis.stationary import Convergence, Kkt, converged, convergence, measured, residuals, scales_of
from divideropt.analysis.summary import Summary, repeatable, summarise
from divideropt.analysis.sweeps import Effect, FailedStretch, Sweep, Sweeps, effects_of, sweeps_of
from divideropt.analysis.treatments import Treatment, Undefined
from divideropt.analysis.verification import Tally, Verified, marked, tally, worth_verifying

__all__ = [
    "INDICATORS",
    "Choice",
    "Comparison",
    "Contender",
    "Convergence",
    "Course",
    "Criterion",
    "Effect",
    "FailedStretch",
    "Goals",
    "House",
    "Indicator",
    "Kkt",
    "MorrisStudy",
    "Optimality",
    "PairTest",
    "Ranking",
    "Scale",
    "Score",
    "SobolStudy",
    "Summary",
    "Sweep",
    "Sweeps",
    "Tally",
    "Treatment",
    "Undefined",
    "Verified",
    "achievement",
    "additive_epsilon",
    "attainment_history",
    "attainment_surface",
    "best_attainment",
    "bulge",
    "choose",
    "combined_front",
    "compare",
    "converged",
    "convergence",
    "course_of",
    "effect_size",
    "effects_of",
    "gaps",
    "holm",
    "house_of_quality",
    "hypervolume",
    "hypervolume_contributions",
    "hypervolume_history",
    "igd_plus",
    "knee_points",
    "marked",
    "measured",
    "median_surface",
    "meeting_goals",
    "morris_study",
    "multiplicative_epsilon",
    "neighbours",
    "nondominated",
    "optimality",
    "pair_tests",
    "probability_above",
    "pseudo_weights",
    "reached",
    "region",
    "repeatable",
    "representatives",
    "residuals",
    "scales_of",
    "several_test",
    "sobol_study",
    "spread",
    "summarise",
    "sweeps_of",
    "tally",
    "worst_surface",
    "worth_verifying",
]
