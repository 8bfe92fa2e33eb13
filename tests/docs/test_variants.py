"""The variants of the page of disagreements are what their labels say."""

import math
from dataclasses import replace

import numpy as np
import pytest
from modelpages.closed_form import closed_flow_ratio, parameters, whole_model
from modelpages.designs import sized_for_two_holes
from modelpages.endflows import LOST, with_end_flows
from modelpages.limits import BOX, sample
from modelpages.measures import dynamic_error_at_ports, settling_of_branch_2
from modelpages.options import FROM_CONSERVATIVE, FROM_LISTING, WHOLE
from modelpages.runs import run

from divideropt.models.divider import FORMULATIONS, parameter_set
from divideropt.models.divider.geometry import derive_geometry
from divideropt.models.divider.kernels import rates

BASE = parameter_set("thesis_base")
CONSERVATIVE = FORMULATIONS["conservative"]


@pytest.mark.parametrize("reading", [*FROM_CONSERVATIVE, *FROM_LISTING], ids=lambda reading: reading.label)
def test_each_reading_changes_its_formulation(reading) -> None:
    assert replace(FORMULATIONS[reading.formulation], **reading.changes) != FORMULATIONS[reading.formulation]


def test_each_change_from_the_physics_is_one_that_the_thesis_makes() -> None:
    theirs = [FORMULATIONS[reading.formulation] for reading in WHOLE[1:]]
    for reading in FROM_CONSERVATIVE:
        assert any(all(getattr(f, name) == v for name, v in reading.changes.items()) for f in theirs)


def test_ports_sized_for_two_holes_make_the_stated_drop() -> None:
    # (3.18) with both holes: half the area, so the drop with the ports fully open is the ΔPt the thesis states.
    smaller = derive_geometry(sized_for_two_holes(BASE), holes=2, stem=True)
    drawn = derive_geometry(BASE, holes=2, stem=True)
    assert smaller.port_radius == pytest.approx(drawn.port_radius / math.sqrt(2), rel=1e-12)
    assert smaller.fixed_area_1 == pytest.approx(drawn.fixed_area_1, rel=1e-12)
    assert smaller.open_drop == pytest.approx(BASE["total_pressure_drop"], rel=1e-12)


def test_the_lost_factor_is_that_between_2_34_and_a_29() -> None:
    # b⁴/(185 μ r √c) of (A.29) against b²/μ √(δ³/(185 h)) of (2.34).
    b, r, h, gap = (BASE[name] for name in ("groove_width", "spool_radius", "land_distance", "radial_clearance"))
    c = 6 * b**4 * h / (185 * r**2 * gap**3)
    assert b**2 * math.sqrt(gap**3 / (185 * h)) / (b**4 / (185 * r * math.sqrt(c))) == pytest.approx(LOST, rel=1e-12)


def test_end_flows_that_are_not_changed_leave_the_text_as_it_is() -> None:
    found = run(BASE, FORMULATIONS["text"])
    changed = with_end_flows(BASE, 1.0, 1.0)[0]
    for name in ("pilot_1", "pilot_2"):
        assert changed[name] == pytest.approx(found.response.phases[-1].design[0][name], rel=1e-12, abs=0)


def test_the_lost_minus_turns_what_the_grooves_of_side_2_take_from_the_supply() -> None:
    # (2.37) against (A.46): the first row is what both grooves add to the supply, -2 Qc2i.
    right, printed = (with_end_flows(BASE, 1.0, sign)[0] for sign in (1.0, -1.0))
    assert printed["pilot_2"][0] == pytest.approx(-right["pilot_2"][0], rel=1e-12)
    assert np.array_equal(printed["pilot_2"][1:], right["pilot_2"][1:])
    assert np.array_equal(printed["pilot_1"], right["pilot_1"])


@pytest.mark.parametrize("position", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("width", [1e-3, 1.35e-3])
def test_the_model_has_the_closed_form_as_its_limit(width, position) -> None:
    p = parameters(width)
    drops, flows = whole_model(p, position)
    assert drops[0] / drops[1] == pytest.approx((1 - position) / position, rel=1e-11)
    assert flows[0] / flows[1] == pytest.approx(closed_flow_ratio(p, position, drops), rel=1e-11)


def test_the_dynamic_error_at_the_ports_is_the_integral_of_their_flows() -> None:
    # The ports' flows from the load lines' own balance (3.1), integrated over instants.
    found = run(BASE, CONSERVATIVE)
    phase = found.response.phases[-1]
    times = np.linspace(0.0, found["settling_time"], 20_001)
    states, design = phase.trajectory.at(times), phase.design
    taken = np.array([rates(0.0, y, design)[7:9] for y in states]) / design[0].load_gain
    ports = phase.load_flows(states, times) + taken
    final = phase.load_flows(phase.rest.state)
    error = np.trapezoid(ports[:, 0] - ports[:, 1] - (final[0] - final[1]), times)
    assert dynamic_error_at_ports(found) == pytest.approx(1e6 * error, rel=1e-4)


def test_branch_2_settles_where_its_flow_last_crosses_its_band() -> None:
    found = run(BASE, CONSERVATIVE)
    phase = found.response.phases[-1]
    at = settling_of_branch_2(found) / 1e3
    before, after = phase.load_flows(phase.trajectory.at(np.array([at, at + 5e-6])))[:, 1]
    final = phase.load_flows(phase.rest.state)[1]
    assert abs(after / final - 1) <= 0.02 < abs(before / final - 1) + 1e-9


def test_the_sample_is_in_the_box_and_the_same_twice() -> None:
    designs = sample(8)
    assert designs == sample(8)
    for design in designs:
        assert all(low <= design[name] <= high for name, (low, high) in BOX.items())
