from dataclasses import replace

import numpy as np
import pytest

from divideropt.models.base import Outcome
from divideropt.models.divider import FORMULATIONS, Divider, Scenario, solver_settings
from divideropt.models.divider.coefficients import Valve
from divideropt.models.divider.equilibrium import find_equilibrium, initial_guess
from divideropt.models.divider.groove_kernels import groove_inlets

TIGHT = solver_settings("LSODA", 1e-8, max_steps=100_000)


@pytest.mark.parametrize(
    ("name", "share", "reynolds", "velocity", "jet"),
    # model.md section 2: "8 %, 990, 52 of 56 m/s" and "36 % at a Reynolds number of 3,000 and 116 m/s, where … 80".
    [("thesis_base", 0.08, 990, 52, 56), ("thesis_prototype", 0.36, 3000, 116, 80)],
)
def test_grooves_of_the_thesis(measured, design, name, share, reynolds, velocity, jet) -> None:
    q = measured(Divider(settings=TIGHT), design(name))
    assert q["pilot_share"] == pytest.approx(share, abs=0.005)
    assert q["groove_reynolds"] == pytest.approx(reynolds, rel=0.01)
    assert q["groove_velocity_ratio"] == pytest.approx(velocity / jet, rel=0.01)
    assert q["within_validity"] == float(reynolds <= 2000 and velocity <= jet)


def test_the_worst_equilibrium_counts(measured, design) -> None:
    # After the step one branch drives its grooves harder than before: by hand from that equilibrium's pressures.
    p = design()
    state = Divider(settings=TIGHT).respond(p).phases[-1].rest.state
    area, viscosity = np.sqrt(3) / 4 * p["groove_width"] ** 2, p["kinematic_viscosity"] * p["density"]
    whole = p["groove_width"] ** 4 / (185 * viscosity * p["spool_radius"] * p["groove_angle"])
    velocity = whole * (state[0] - state[1:3]) / area  # no leakage over the lands: 1e-5 of it at 2.9 µm
    q = measured(Divider(settings=TIGHT), p)
    diameter = p["groove_width"] / np.sqrt(3)
    assert q["groove_reynolds"] == pytest.approx(velocity.max() * diameter / p["kinematic_viscosity"], rel=0.05)
    jets = np.sqrt(2 * (state[0] - state[1:3]) / p["density"])
    assert q["groove_velocity_ratio"] == pytest.approx((velocity / jets).max(), rel=0.05)


def loss_record(p, **options):
    valve = Valve.of(p, replace(FORMULATIONS["conservative"], groove_loss=True, **options))
    return valve.under(Scenario(spool_position=0.4).spans()[-1].inputs)


def test_losses_at_the_ends_of_a_groove(design) -> None:
    """At rest no fluid leaves a tap: one flow passes both stretches, and their drops are those of a quadratic."""
    p = design("thesis_prototype", radial_clearance=1e-7)  # tight: no leakage along the grooves
    record = loss_record(p)
    rest = find_equilibrium(record, initial_guess(record)).state
    viscosity, area = p["kinematic_viscosity"] * p["density"], np.sqrt(3) / 4 * p["groove_width"] ** 2
    resistance = 185 * viscosity * p["spool_radius"] * p["groove_angle"] / p["groove_width"] ** 4
    head = p["density"] / (2 * area**2)
    flows = groove_inlets(rest, record[0])
    for flow, near, pa, pb in zip(flows, (0.4, 0.6), rest[1:3], rest[3:5], strict=True):
        assert rest[0] - pb == pytest.approx(near * resistance * flow + 0.5 * head * flow**2, rel=1e-6)
        assert pb - pa == pytest.approx((1 - near) * resistance * flow + 1.0 * head * flow**2, rel=1e-6)


def test_no_fluid_is_lost_with_the_losses(box_designs) -> None:
    for p in box_designs(32):
        record = loss_record(p)
        rest = find_equilibrium(record, initial_guess(record))
        d, y = record[0], rest.state
        loads = d.load_1 * np.sqrt(y[7]) + d.load_2 * np.sqrt(y[8])
        assert abs(loads + d.seal_leakage * (y[3] + y[4]) - d.source_flow) < 1e-12 * d.source_flow


def test_a_loss_factor_of_zero_is_no_loss(measured, design) -> None:
    without = measured(Divider(settings=TIGHT), design())
    nothing = measured(Divider(settings=TIGHT, groove_loss=True), design(groove_loss_factor=0.0))
    assert nothing == without
    ignored = measured(Divider(settings=TIGHT), design(groove_loss_factor=9.0))
    assert ignored == without


@pytest.mark.parametrize("name", ["thesis_prototype", "thesis_optimum"])
def test_with_losses_no_groove_outruns_its_jet(measured, design, name) -> None:
    q = measured(Divider(settings=TIGHT, groove_loss=True), design(name))
    assert q["outcome"] is Outcome.OK
    assert q["groove_velocity_ratio"] < 1 / np.sqrt(1.5)
    assert q["pilot_share"] < measured(Divider(settings=TIGHT), design(name))["pilot_share"]
