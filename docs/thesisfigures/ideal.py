"""Figure 2.6: what its caption and section 2.2 say of the ideal flow fraction."""

import numpy as np
from claims.criteria import BENT, STRAIGHT, off_line, straight
from claims.judgement import Answer, Judgement, all_of
from modelpages.figures import NEAR_LINEAR

from divideropt.models.divider.ideal import flow_fraction, flow_ratio
from thesisfigures.figure import Both, Row

AREA_RATIOS = {"1:1": 1.0, "2:1": 2.0, "1:2": 0.5}
"""Ao1/Ao2 of the figure's curves."""

EVEN = 1e-12
"""Flows whose ratio is off 1 by this are equal."""

NAME = "ideal analysis"


def judge_ideal(_: Both) -> list[Row]:
    """Judge both statements; no formulation matters to them."""
    low, high = NEAR_LINEAR
    return [
        Row(
            "",
            f"Notice the approximately linear region between φ/φ0 = {low} and {high}",
            f"For each ratio of the orifices: yes if (2.7) leaves the line of least squares by at most "
            f"{100 * STRAIGHT:g} % of its range there, in part up to {100 * BENT:g} %.",
            {NAME: all_of([_straight(words, ratio) for words, ratio in AREA_RATIOS.items()])},
        ),
        Row(
            "",
            "at this central position [the ratio] is not necessarily 50-50, as other base ratios can be achieved by "
            "using non-equal fixed orifice areas",
            "Yes if (2.6) at φ/φ0 = 0.5 is 1 for equal orifices alone.",
            {NAME: _base_ratios()},
        ),
    ]


def _straight(words: str, ratio: float) -> Judgement:
    places = np.linspace(*NEAR_LINEAR, 201)
    off = off_line(places, flow_fraction(places, ratio))
    return Judgement(straight(off), f"{words} at most {100 * off:.1f} % off")


def _base_ratios() -> Judgement:
    ratios = {words: flow_ratio(0.5, ratio) for words, ratio in AREA_RATIOS.items()}
    even = [words for words, ratio in ratios.items() if abs(ratio - 1) <= EVEN]
    figures = ", ".join(f"{words} gives QL1/QL2 = {ratio:g}" for words, ratio in ratios.items())
    return Judgement(Answer.YES if even == ["1:1"] else Answer.NO, figures)
