"""The groove profiles that are drawn are those whose flows the model uses."""

import numpy as np
import pytest
from modelpages.profile import groove_pressure

from divideropt.models.divider.formulations import Pilot
from divideropt.models.divider.groove_kernels import fold_side

LENGTH, TAP, END = 0.9, 0.5, 1.4
PRESSURES = (18.7e6, 18.0e6, 17.3e6)


def profile(pilot, angles):
    return groove_pressure(pilot, np.asarray(angles), TAP, END, LENGTH, PRESSURES)


@pytest.mark.parametrize("pilot", Pilot)
def test_it_has_the_pressures_of_supply_tap_and_outlet(pilot) -> None:
    assert profile(pilot, [0.0, TAP, END]) == pytest.approx(np.array(PRESSURES), rel=1e-12)


@pytest.mark.parametrize(
    ("pilot", "sign", "about"),
    [(Pilot.HYPERBOLIC, 1, 0.5), (Pilot.TRIGONOMETRIC, -1, 0.5), (Pilot.HOMOGENEOUS, -1, 0)],
)
def test_it_solves_its_equation(pilot, sign, about) -> None:
    # c P'' = ±(P - Pm), or about zero, by central differences.
    mean = about * (PRESSURES[1] + PRESSURES[2])
    step = 1e-3
    for middle in (0.2, 0.3, 0.8, 1.1):
        low, at, high = profile(pilot, [middle - step, middle, middle + step])
        curvature = LENGTH**2 * (high - 2 * at + low) / step**2
        assert curvature == pytest.approx(sign * (at - mean), rel=1e-4, abs=1e2)


@pytest.mark.parametrize("pilot", Pilot)
def test_its_slopes_are_the_flows_of_the_model(pilot) -> None:
    # Q = -G √c P' at supply, both sides of the tap, and outlet, with G = 1.
    rows = fold_side(int(pilot), 1.0, LENGTH, 1.0, TAP, END - TAP, 1.0)
    inlet, arriving, tap, outlet = rows[:4] @ np.array([PRESSURES[0], PRESSURES[2], PRESSURES[1]])
    step = 1e-5

    def flow(first, second, third):
        a, b, c = profile(pilot, [first, second, third])
        return -LENGTH * (-3 * a + 4 * b - c) / (2 * (second - first))

    assert flow(0.0, step, 2 * step) == pytest.approx(inlet, rel=1e-5)
    assert flow(TAP, TAP - step, TAP - 2 * step) == pytest.approx(arriving, rel=1e-5)
    assert flow(END, END - step, END - 2 * step) == pytest.approx(outlet, rel=1e-5)
    beyond = flow(TAP + 1e-12, TAP + 1e-12 + step, TAP + 1e-12 + 2 * step)
    assert arriving - beyond == pytest.approx(tap, rel=1e-4, abs=1e-5 * abs(arriving))


def test_its_integral_is_the_leakage_of_the_model() -> None:
    angles = np.concatenate([np.linspace(0.0, TAP, 2001), np.linspace(TAP, END, 2001)[1:]])
    pressure = profile(Pilot.HYPERBOLIC, angles)
    rows = fold_side(int(Pilot.HYPERBOLIC), 1.0, LENGTH, 1.0, TAP, END - TAP, 1.0)
    end_leakage, chamber_leakage = rows[4:] @ np.array([PRESSURES[0], PRESSURES[2], PRESSURES[1]])
    assert np.trapezoid(PRESSURES[1] - pressure, angles) == pytest.approx(end_leakage, rel=1e-5)
    assert np.trapezoid(pressure - PRESSURES[2], angles) == pytest.approx(chamber_leakage, rel=1e-5)
