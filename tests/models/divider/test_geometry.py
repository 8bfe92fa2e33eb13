import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from divideropt.models.divider.geometry import derive_geometry


def test_base_set_by_hand(design) -> None:
    """Appendix B.1 put into calcparams.m (C.1) with a pocket calculator's precision."""
    g = derive_geometry(design(), holes=2)
    assert g.viscosity == pytest.approx(0.027)  # 30e-6 * 900
    assert g.stem_radius == pytest.approx(2.4e-3)
    assert g.end_area == pytest.approx(math.pi * (64e-6 - 5.76e-6))
    assert g.spool_length == pytest.approx(0.1)  # 8 * 5 mm / 0.4
    assert g.mass == pytest.approx(0.5 * 64e-6 * math.pi * 0.1 * 7870)
    assert g.viscous_friction == pytest.approx(2 * math.pi * 8e-3 * 0.04 * 0.027 / 2.9e-6)
    root = math.sqrt(2 / 900 * 1.5e6)
    assert g.fixed_area_1 == g.fixed_area_2 == pytest.approx(5e-4 / (0.61 * root))
    assert g.port_radius == pytest.approx(math.sqrt(5e-4 / (0.61 * math.pi * root)))
    assert g.port_offset == 0.0  # half open
    assert g.stop_position == pytest.approx(1.3 * g.port_radius)
    assert g.end_volume == pytest.approx((2.5e-3 + g.stop_position) * g.end_area)
    assert g.chamber_volume == pytest.approx(math.pi * (64e-6 - 16e-6) * 20e-3)
    assert g.seal_leakage == pytest.approx(2.4e-3 * math.pi * 2.9e-6**3 / (6 * 0.027 * 5e-3))


def test_ports_are_those_of_the_authors_code(reference, listing_design) -> None:
    rows = reference("listing_derivatives")
    found = np.array(
        [
            (g.port_radius, g.port_offset, g.stop_position)
            for g in (derive_geometry(listing_design(row), holes=2) for row in rows.itertuples())
        ]
    )
    expected = rows[["rv", "d0", "xmax"]].to_numpy()
    # An offset is a difference of radii, and so is its rounding.
    assert (np.abs(found - expected) <= 1e-14 * expected[:, [0]]).all()


def test_open_drop_counts_the_holes(design) -> None:
    # model.md section 3: 1.87 MPa at the base set, not the 3.0 by which the port is sized.
    assert derive_geometry(design(), holes=2).open_drop == pytest.approx(1.875e6)
    assert derive_geometry(design(), holes=1).open_drop == pytest.approx(3.0e6)


@given(st.floats(1e5, 1e8), st.floats(0.05, 0.99), st.floats(1e-5, 1e-2), st.floats(0.3, 1.0), st.floats(0.3, 1.0))
def test_orifices_pass_the_design_flow_at_their_drop(design, drop, share, flow, fixed, variable) -> None:
    p = design(
        total_pressure_drop=drop,
        fixed_drop_ratio=share,
        design_flow=flow,
        fixed_discharge=fixed,
        variable_discharge=variable,
    )
    g = derive_geometry(p, holes=1)
    through_fixed = fixed * g.fixed_area_1 * math.sqrt(2 / 900 * share * drop)
    through_port = variable * math.pi * g.port_radius**2 * math.sqrt(2 / 900 * (1 - share) * drop)
    assert through_fixed == pytest.approx(flow, rel=1e-12)
    assert through_port == pytest.approx(flow, rel=1e-11)
    assert g.open_drop == pytest.approx(drop, rel=1e-12)


@given(st.floats(0.01, 100.0))
def test_unequal_orifices_share_one_area(design, ratio) -> None:
    equal = derive_geometry(design(), holes=2)
    g = derive_geometry(design(fixed_area_ratio=ratio), holes=2)
    assert g.fixed_area_1 / g.fixed_area_2 == pytest.approx(ratio, rel=1e-12)
    assert g.fixed_area_1 + g.fixed_area_2 == pytest.approx(2 * equal.fixed_area_1, rel=1e-14)


@given(st.floats(0.01, 0.99))
def test_centred_opening_places_the_port_on_the_edge(design, opening) -> None:
    g = derive_geometry(design(centred_opening=opening), holes=2)
    assert (g.port_radius - g.port_offset) / (2 * g.port_radius) == pytest.approx(opening, rel=1e-12)
    assert g.stop_position > g.port_radius + g.port_offset  # a port can open fully
    assert g.end_volume > g.end_area * g.stop_position  # an end chamber never vanishes
