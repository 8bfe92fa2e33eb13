"""The ideal valve against the equations it is solved from, and against what section 2.2 says of Figure 2.6."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from divideropt.models.divider.ideal import desired_flows, flow_fraction, flow_ratio

POSITION = st.floats(0.01, 0.99)
AREA_RATIO = st.floats(0.1, 10.0)


@given(POSITION, AREA_RATIO)
def test_the_ratio_solves_the_equations_it_comes_from(position, area_ratio) -> None:
    # (2.1)-(2.5) solved for Pa2 by bracketing, with Ps = 2 and Pa1 = 1: the ratio of the orifice flows.
    source, first = 2.0, 1.0
    end_1 = source - position * (source - first)
    second = brentq(lambda pa2: pa2 - position * (pa2 - source) - end_1, -1e3, 2.0, xtol=1e-14, rtol=1e-14)
    ratio = area_ratio * np.sqrt((source - first) / (source - second))
    assert flow_ratio(position, area_ratio) == pytest.approx(ratio, rel=1e-9)


@given(POSITION, AREA_RATIO)
def test_the_two_branches_take_the_whole_flow(position, area_ratio) -> None:
    # Seen from branch 2 the valve is the one with the other orifices, turned the other way.
    other = flow_fraction(1.0 - position, 1.0 / area_ratio)
    assert flow_fraction(position, area_ratio) + other == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(("area_ratio", "fraction"), [(0.5, 1 / 3), (1.0, 1 / 2), (2.0, 2 / 3)])
def test_a_centred_spool_divides_as_the_orifices_do(area_ratio, fraction) -> None:
    assert flow_fraction(0.5, area_ratio) == pytest.approx(fraction, rel=1e-15)


def test_figure_2_6_is_nearly_straight_between_a_quarter_and_three_quarters() -> None:
    # Section 2.2 calls it near-linear there: the curve stays within 0.4 % of the source flow of its chord (0.36 %),
    # and outside it does not.
    def off_chord(low, high):
        places = np.linspace(low, high, 201)
        curve = flow_fraction(places, 1.0)
        return np.abs(curve - np.interp(places, [low, high], [curve[0], curve[-1]])).max()

    assert off_chord(0.25, 0.75) < 0.004
    assert off_chord(0.05, 0.95) > 0.03


@given(st.lists(POSITION, min_size=1, max_size=5), AREA_RATIO)
def test_an_array_of_positions_gives_what_each_gives(positions, area_ratio) -> None:
    together = flow_fraction(np.array(positions), area_ratio)
    alone = [flow_fraction(position, area_ratio) for position in positions]
    assert together == pytest.approx(np.array(alone), rel=1e-15)


@given(POSITION, AREA_RATIO)
def test_the_desired_flows_have_the_ratio_and_the_sum(position, area_ratio) -> None:
    first, second = desired_flows(position, area_ratio, 1e-3)
    assert first + second == pytest.approx(1e-3, rel=1e-12)
    assert first / second == pytest.approx(flow_ratio(position, area_ratio), rel=1e-9)
