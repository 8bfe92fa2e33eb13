"""What is played: test problems with known fronts, and the valve."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import moocore
import numpy as np
from pymoo.problems.many import DTLZ1, DTLZ2, DTLZ7
from pymoo.problems.multi import BNH, OSY, SRN, TNK, ZDT1, ZDT2, ZDT3, ZDT4, ZDT6, Truss2D, WeldedBeam
from pymoo.util.ref_dirs import get_reference_directions

from divideropt.campaign.load import load_campaign
from divideropt.campaign.plan import build_problem, reference_of
from divideropt.models.base import FloatArray
from divideropt.problem import Problem

from . import fronts
from .formulas import problem_of

CAMPAIGN = Path(__file__).parents[2] / "campaigns" / "divider.yaml"

VALVE = "valve"

FRONT_POINTS = 1000
"""Points of a front that is a curve, from which IGD+ is measured."""


@dataclass(frozen=True)
class Case:
    """One problem, and what is known of it.

    Attributes:
        name: In tables.
        problem: In our words.
        ideal: Of each objective, shape (k,): 0 of the normalised objectives.
        span: From there to 1 of them, shape (k,).
        corner: The hypervolume's reference point in each normalised objective.
        front: Points of the known front, normalised, shape (n, k); None for the valve.
        volume: The known front's hypervolume, normalised; None for the valve.
    """

    name: str
    problem: Problem
    ideal: FloatArray
    span: FloatArray
    corner: float
    front: FloatArray | None = None
    volume: float | None = None

    def normalised(self, F: FloatArray) -> FloatArray:
        """Return objectives between ideal and ideal + span, shape (n, k), as 0 to 1."""
        return np.asarray((F - self.ideal) / self.span)

    def hypervolume(self, points: FloatArray) -> float:
        """Return what normalised points dominate up to the corner."""
        if len(points) == 0:
            return 0.0
        return float(moocore.hypervolume(points, ref=np.full(points.shape[1], self.corner)))


@cache
def case_of(name: str) -> Case:
    """Make a case by its name in `NAMES`."""
    return _valve() if name == VALVE else _known(name, *_KNOWN[name])


def _known(
    name: str,
    make: Callable[[], Any],
    front_of: Callable[[Any], FloatArray],
    volume_of: Callable[[FloatArray, FloatArray], float] | None,
) -> Case:
    formula = make()
    front = front_of(formula)
    ideal, nadir = front.min(axis=0), front.max(axis=0)
    span = nadir - ideal
    problem = problem_of(formula, np.abs(front).max(axis=0))
    case = Case(name, problem, ideal, span, fronts.CORNER)
    volume = case.hypervolume(case.normalised(front)) if volume_of is None else volume_of(ideal, span)
    few = front if front.shape[1] > 2 else _thinned(front)
    return Case(name, problem, ideal, span, fronts.CORNER, case.normalised(few), volume)


def _thinned(curve: FloatArray) -> FloatArray:
    """Return some points of a front that is a curve, its ends among them."""
    rows = np.linspace(0, len(curve) - 1, FRONT_POINTS).astype(int)
    return np.asarray(curve[np.argsort(curve[:, 0])][rows])


def _valve() -> Case:
    campaign = load_campaign(CAMPAIGN)
    reference = reference_of(campaign)
    assert reference is not None, "divider.yaml gives a reference point"
    return Case(VALVE, build_problem(campaign), np.zeros(len(reference)), reference, corner=1.0)


def _dense(formula: Any) -> FloatArray:
    return np.asarray(formula.pareto_front(n_points=fronts.DENSE))


def _dense_zdt(formula: Any) -> FloatArray:
    return np.asarray(formula.pareto_front(n_pareto_points=fronts.DENSE))


def _over_directions(formula: Any) -> FloatArray:
    return np.asarray(formula.pareto_front(get_reference_directions("das-dennis", 3, n_partitions=40)))


_KNOWN: Mapping[str, tuple[Callable[[], Any], Callable[[Any], FloatArray], Any]] = MappingProxyType(
    {
        "ZDT1": (ZDT1, _dense_zdt, None),
        "ZDT2": (ZDT2, _dense_zdt, None),
        "ZDT3": (ZDT3, _dense, None),
        "ZDT4": (ZDT4, _dense_zdt, None),
        "ZDT6": (ZDT6, _dense_zdt, None),
        "DTLZ1": (lambda: DTLZ1(n_var=7, n_obj=3), _over_directions, lambda *_: fronts.dtlz1_volume()),
        "DTLZ2": (lambda: DTLZ2(n_var=12, n_obj=3), _over_directions, lambda *_: fronts.dtlz2_volume()),
        "DTLZ7": (lambda: DTLZ7(n_var=22, n_obj=3), lambda _: fronts.dtlz7(), fronts.dtlz7_volume),
        "BNH": (BNH, _dense, None),
        "SRN": (SRN, _dense, None),
        "TNK": (TNK, lambda _: fronts.tnk(), None),
        "OSY": (OSY, lambda _: fronts.osy(), None),
        "Truss2D": (Truss2D, lambda _: fronts.truss(), None),
        "WeldedBeam": (WeldedBeam, lambda _: fronts.welded_beam(), None),
    }
)
"""How a test problem is made, its front, and its hypervolume where that of the front's points is not near enough."""

NAMES = (*_KNOWN, VALVE)
