import math

import pytest

from divideropt.models.divider import Divider, Scenario, load_step, solver_settings
from divideropt.models.divider.equilibrium import find_equilibrium, initial_guess
from divideropt.models.divider.ideal import flow_ratio

# docs/model/pilot.md: without leakage, rim, friction and seals the taps' pressures are shares of the drops, and the
# pilot flow passes by the fixed orifices.


def closed_form(p, position: float, source_flow: float) -> float:
    """QL1/QL2, from Δ1/Δ2 = (1-ρ)/ρ and (K√Δ1 + 2gΔ1) + (K√Δ2 + 2gΔ2) = Qs."""
    area = p["design_flow"] / (
        p["fixed_discharge"] * math.sqrt(2 / p["density"] * p["fixed_drop_ratio"] * p["total_pressure_drop"])
    )
    orifice = p["fixed_discharge"] * area * math.sqrt(2 / p["density"])
    viscosity = p["kinematic_viscosity"] * p["density"]
    groove = p["groove_width"] ** 4 / (185 * viscosity * p["spool_radius"] * p["groove_angle"])

    def flow(drop: float) -> float:
        return orifice * math.sqrt(drop) + 2 * groove * drop

    low, high = 0.0, 1e9
    for _ in range(200):
        middle = (low + high) / 2
        total = flow(middle) + flow(middle * position / (1 - position))
        low, high = (middle, high) if total < source_flow else (low, middle)
    return flow(low) / flow(low * position / (1 - position))


@pytest.mark.parametrize("loads", [(10e6, 10e6), (15e6, 10e6)])
@pytest.mark.parametrize("position", [0.3, 0.4, 0.5, 0.6, 0.7])
@pytest.mark.parametrize("width", [0.2e-3, 1e-3, 1.35e-3])
def test_the_valve_without_its_errors(design, record, position, width, loads) -> None:
    p = design(groove_width=width, radial_clearance=1e-8, rim_thickness=0.0)
    scenario = Scenario(spool_position=position, load_pressures=loads)
    rec = record(p, phase=0, scenario=scenario, end_seals=False)
    rest = find_equilibrium(rec, initial_guess(rec)).state
    d = rec[0]
    drops = rest[0] - rest[1:3]
    assert drops[0] / drops[1] == pytest.approx((1 - position) / position, rel=1e-9)
    ratio = float(d.load_1 * math.sqrt(rest[7]) / (d.load_2 * math.sqrt(rest[8])))
    assert ratio == pytest.approx(closed_form(p, position, 1e-3), rel=1e-9)


@pytest.mark.parametrize(("width", "shift"), [(0.1e-3, 0.0), (1e-3, 3.4), (1.35e-3, 8.8)])
def test_the_pilot_flow_shifts_the_ratio(design, width, shift) -> None:
    # The figures at ρ = 0.3; (2.6) holds as b → 0 only.
    p = design(groove_width=width)
    assert 100 * (closed_form(p, 0.3, 1e-3) / flow_ratio(0.3, 1.0) - 1) == pytest.approx(shift, abs=0.05)


def test_the_step_does_not_matter_to_it(measured, design) -> None:
    # Section 2.2's "insensitivity to load pressure variations", through the whole simulation.
    p = design(radial_clearance=1e-8, rim_thickness=0.0, seal_length=1e6)
    scenario = Scenario(spool_position=0.4, events=(load_step(1, 15e6),))
    q = measured(Divider(scenario=scenario, settings=solver_settings(max_steps=100_000)), p)
    assert abs(q["load_regulation"]) < 1e-7
