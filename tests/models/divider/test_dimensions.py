"""The divider's dimensions against formulas written here anew, and back from dimensions to parameters."""

import math

import numpy as np
import pytest

from divideropt.models.dimensions import Dimensioned, Kind, points_of
from divideropt.models.divider import PARAMETERS, Divider, parameter_set

OTHERS = {
    "thesis_base": {},
    "thesis_prototype": {"fixed_area_ratio": 1.5, "groove_angle": 1.0},
    "thesis_optimum": {"centred_opening": 0.9, "land_length_ratio": 2.0, "chamber_length": 0.2},
}


def measured(p, model=None):
    model = model or Divider()
    row = model.measured(np.array([[p[name] for name in PARAMETERS]]))[0]
    return dict(zip(model.dimensions, row.tolist(), strict=True))


@pytest.fixture(params=OTHERS)
def design(request):
    return parameter_set(request.param) | OTHERS[request.param]


def test_the_divider_offers_dimensions_and_a_sketch():
    model = Divider()
    assert isinstance(model, Dimensioned)
    for name, dimension in model.dimensions.items():
        assert name == dimension.name
        assert dimension.unit == {"area": "m^2", "volume": "m^3", "mass": "kg", "angle": "rad"}.get(
            dimension.kind, "m"
        )
        assert set(dimension.made_of) <= set(PARAMETERS)
    assert {dimension.kind for dimension in model.dimensions.values()} == set(Kind)


def test_areas_volumes_and_mass_are_those_of_the_shapes(design):
    found = measured(design)
    pi, r = math.pi, design["spool_radius"]
    speed = math.sqrt(2.0 * design["fixed_drop_ratio"] * design["total_pressure_drop"] / design["density"])
    orifice = design["design_flow"] / (design["fixed_discharge"] * speed)
    assert found["fixed_area_1"] + found["fixed_area_2"] == pytest.approx(2.0 * orifice, rel=1e-12)
    assert found["fixed_area_1"] / found["fixed_area_2"] == pytest.approx(design["fixed_area_ratio"], rel=1e-12)
    for number in (1, 2):
        hole = pi / 4.0 * found[f"fixed_orifice_diameter_{number}"] ** 2
        assert hole == pytest.approx(found[f"fixed_area_{number}"], rel=1e-12)
    assert found["spool_diameter"] == 2.0 * r
    ring = pi / 4.0 * (found["spool_diameter"] ** 2 - found["stem_diameter"] ** 2)
    assert found["spool_end_area"] == pytest.approx(ring, rel=1e-12)
    solid = pi * r**2 * found["spool_length"] * 7870.0
    assert found["spool_mass"] == pytest.approx(design["mass_ratio"] * solid, rel=1e-12)
    assert found["chamber_volume"] == pytest.approx(0.75 * pi * r**2 * design["chamber_length"], rel=1e-12)
    assert found["end_volume"] == pytest.approx(ring * (design["end_clearance"] + found["stop_position"]), rel=1e-12)
    assert found["groove_area"] == pytest.approx(design["groove_width"] * found["groove_depth"] / 2.0, rel=1e-12)
    assert found["stroke"] == pytest.approx(2.0 * 1.3 * (found["port_offset"] + found["port_diameter"] / 2.0))
    assert found["port_opening"] / found["port_diameter"] == pytest.approx(design["centred_opening"], rel=1e-12)


def test_the_open_part_of_a_port_is_the_area_of_its_segment(design):
    found = measured(design)
    radius, offset = found["port_diameter"] / 2.0, found["port_offset"]
    x = np.linspace(offset, radius, 200_001)
    strips = 2.0 * np.sqrt(np.maximum(radius**2 - x**2, 0.0))
    assert found["port_open_area"] == pytest.approx(np.trapezoid(strips, x), rel=1e-6)


def test_the_quantities_of_a_simulation_are_the_same(design):
    model = Divider()
    values, _ = model.evaluate(np.array([[design[name] for name in PARAMETERS]]))
    known, found = dict(zip(model.quantities, values[0], strict=True)), measured(design)
    assert [found[name] for name in ("spool_mass", "stroke", "spool_length")] == pytest.approx(
        [known[name] for name in ("spool_mass", "stroke", "spool_length")], rel=1e-14
    )


def test_the_lands_as_drawn_add_up(design):
    found = measured(design)
    lands = 2.0 * found["drawn_outer_land"] + found["drawn_middle_land"]
    assert lands == pytest.approx(found["land_length"], rel=1e-12)
    whole = lands + 2.0 * (found["drawn_chamber"] + found["drawn_stem"])
    assert whole == pytest.approx(found["spool_length"], rel=1e-12)
    assert min(value for name, value in found.items() if name.startswith("drawn_")) >= -1e-15
    assert parameter_set("thesis_base")["chamber_length"] == measured(parameter_set("thesis_base"))["drawn_chamber"]


def test_changed_dimensions_are_what_the_remade_design_has(design):
    old = measured(design)
    asked = {name: value * 1.01 for name, value in old.items() if Divider().dimensions[name].made_of}
    made = Divider().remade(design, asked)
    new = measured(made)
    assert {name: new[name] for name in asked} == pytest.approx(asked, rel=1e-12)
    one = Divider().remade(design, {"groove_width": 1.25e-3})
    assert {name for name in PARAMETERS if one[name] != design[name]} == {"groove_width"}


def test_every_measure_of_the_sketch_is_the_dimension_it_names(design):
    model, found = Divider(), {name: np.array([value]) for name, value in measured(design).items()}
    for view in model.sketch.views:
        assert {form.constant for point in points_of(view.shapes) for form in point} <= {
            0.0,
            5e-3,
            -5e-3,
            1.5e-3,
            -1.5e-3,
        }
        for m in view.measures:
            axis = 0 if m.side in ("above", "below") else 1
            length = float((m.end[axis] - m.begin[axis]).of(found)[0])
            assert length == pytest.approx(float(found[m.name][0]), rel=1e-12), (view.title, m.name)


def test_a_formulation_without_a_stem_has_the_whole_end(design):
    found = measured(design, Divider(formulation="text"))
    assert found["spool_end_area"] == pytest.approx(math.pi * design["spool_radius"] ** 2, rel=1e-12)
