"""The divider's dimensions: those that a workshop makes, and what follows from them.

Lengths, areas, volumes and the mass are those of the model, (3.13)–(3.22) as `derive` codes them. The model has radii
where a drawing has diameters, and areas of the fixed orifices where a drawing has holes: a fixed orifice is given as
one round hole of its area. How the total land length L_L lies on the spool is not in the model, which needs only the
distance h from a groove to its land's edges and the chamber length La; the arrangement that is drawn is the one in
which the base set comes out even, our own reading: an outer land of 2h with the groove in its middle at either end,
the rest of L_L between the ports, La to either side of it, and equal stems for what is left of L_T. Where a set of
parameters leaves no room for that, the outer lands share L_L, and the chambers what L_T leaves.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.dimensions import Dimension, Kind
from divideropt.models.divider.coefficient_kernels import derive
from divideropt.models.divider.formulations import Formulation
from divideropt.models.divider.geometry import parameter_row
from divideropt.models.divider.parameters import PARAMETERS
from divideropt.models.divider.record import GEOMETRY, Records, parameter_rows

_SIZING = ("total_pressure_drop", "fixed_drop_ratio", "design_flow", "density")
_FIXED = (*_SIZING, "fixed_discharge", "fixed_area_ratio")
_PORT = (*_SIZING, "variable_discharge")

_AS_GIVEN = ("groove_width", "rim_thickness", "land_distance", "chamber_length", "end_clearance", "seal_length")
"""Dimensions that are parameters themselves."""

_D, _L, _A, _V = Kind.DIAMETER, Kind.LENGTH, Kind.AREA, Kind.VOLUME

_TABLE = (
    Dimension("spool_diameter", "m", "2r", "of the spool's lands", _D, ("spool_radius",)),
    Dimension("stem_diameter", "m", "2r_stem", "of the stems in the end seals", _D, ("spool_radius", "stem_ratio")),
    Dimension("port_diameter", "m", "2r_v", "of each of a port's two holes, (3.18)", _D, _PORT),
    Dimension("fixed_orifice_diameter_1", "m", "d_o1", "of fixed orifice 1 as one round hole, (3.17)", _D, _FIXED),
    Dimension("fixed_orifice_diameter_2", "m", "d_o2", "of fixed orifice 2 as one round hole", _D, _FIXED),
    Dimension("groove_width", "m", "b", "side of the pilot groove's triangle", _L, ("groove_width",)),
    Dimension("groove_depth", "m", "√3/2 b", "of the pilot groove", _L),
    Dimension("groove_arc", "m", "r φ0", "of a pilot groove along the land", _L),
    Dimension(
        "port_opening",
        "m",
        "r_v - d_0",
        "of a port from its edge to the land's, spool centred, (3.19)",
        _L,
        (*_PORT, "centred_opening"),
    ),
    Dimension("port_offset", "m", "d_0", "from the land's edge to a port's centre, spool centred, (3.19)", _L),
    Dimension("stop_position", "m", "x_max", "from the centre to the stop, 1.3 (d_0 + r_v)", _L),
    Dimension("stroke", "m", "2x_max", "of the spool, stop to stop", _L),
    Dimension("radial_clearance", "m", "δ", "between spool and sleeve; a fit, never rounded", _L),
    Dimension("rim_thickness", "m", "t_rim", "of the rim at a port's edge", _L, ("rim_thickness",)),
    Dimension("land_distance", "m", "h", "from groove to the land's edge", _L, ("land_distance",)),
    Dimension("land_length", "m", "L_L", "of all lands", _L),
    Dimension("spool_length", "m", "L_T", "of the spool", _L),
    Dimension("chamber_length", "m", "La", "flow chamber, between the lands", _L, ("chamber_length",)),
    Dimension("end_clearance", "m", "Lv", "spool to cap at the end of its stroke", _L, ("end_clearance",)),
    Dimension("seal_length", "m", "Ls", "of the end seals", _L, ("seal_length",)),
    Dimension("groove_angle", "rad", "φ0", "angle the pilot groove covers", Kind.ANGLE),
    Dimension("spool_end_area", "m^2", "A", "on which an end pressure acts, (3.13)", _A),
    Dimension("fixed_area_1", "m^2", "Ao1", "of fixed orifice 1, (3.17)", _A),
    Dimension("fixed_area_2", "m^2", "Ao2", "of fixed orifice 2", _A),
    Dimension("port_area", "m^2", "π r_v^2", "of one hole of a port, fully open", _A),
    Dimension("port_open_area", "m^2", "Av", "of one hole of a port, spool centred, (2.15)", _A),
    Dimension("groove_area", "m^2", "√3/4 b^2", "of a pilot groove's section", _A),
    Dimension("end_volume", "m^3", "V_1o", "of an end chamber, spool centred, (3.20)", _V),
    Dimension("chamber_volume", "m^3", "V_a", "of a flow chamber, (3.22)", _V),
    Dimension("spool_mass", "kg", "m", "of the spool, (3.14)", Kind.MASS),
    *(
        Dimension(name, "m", symbol, "as drawn", _L, listed=False)
        for name, symbol in {
            "drawn_outer_land": "",
            "drawn_distance": "h",
            "drawn_middle_land": "",
            "drawn_chamber": "La",
            "drawn_stem": "",
            "groove_rise": "",
            "groove_run": "",
            "groove_depth_rise": "",
            "groove_depth_run": "",
        }.items()
    ),
)

DIMENSIONS: Mapping[str, Dimension] = MappingProxyType({d.name: d for d in _TABLE})
"""Every dimension by name, in the order of a row of `measured`."""


def measured(designs: FloatArray, reading: Formulation) -> FloatArray:
    """Return the dimensions of designs; `Dimensioned.measured`."""
    rows = parameter_rows(designs)
    found = _of(rows, reading.stem)
    return np.column_stack([found[name] for name in DIMENSIONS])


def remade(design: Mapping[str, float], dimensions: Mapping[str, float]) -> dict[str, float]:
    """Return the parameters of a design some of whose dimensions are others; `Dimensioned.remade`.

    Diameters and opening come back by (3.17)–(3.19) solved for the pressure drops and the fraction open.
    """
    p = dict(design)
    old = _of(parameter_row(p), stem=True)
    new = {name: float(column[0]) for name, column in old.items()} | dict(dimensions)
    if dimensions.keys() & {"spool_diameter", "stem_diameter"}:
        p["spool_radius"], p["stem_ratio"] = new["spool_diameter"] / 2.0, new["stem_diameter"] / new["spool_diameter"]
    orifices = {"fixed_orifice_diameter_1", "fixed_orifice_diameter_2"}
    if dimensions.keys() & {"port_diameter", *orifices}:
        area_1, area_2 = (math.pi / 4.0 * new[name] ** 2 for name in sorted(orifices))
        fixed = _drop(p, "fixed_discharge", (area_1 + area_2) / 2.0)
        variable = _drop(p, "variable_discharge", math.pi / 4.0 * new["port_diameter"] ** 2)
        p["total_pressure_drop"], p["fixed_drop_ratio"] = fixed + variable, fixed / (fixed + variable)
        p["fixed_area_ratio"] = area_1 / area_2 if dimensions.keys() & orifices else p["fixed_area_ratio"]
    if dimensions.keys() & {"port_diameter", "port_opening"}:
        p["centred_opening"] = new["port_opening"] / new["port_diameter"]  # rv - d0 = 2 FO rv, (3.19)
    return p | {name: dimensions[name] for name in _AS_GIVEN if name in dimensions}


def _drop(p: Mapping[str, float], discharge: str, area: float) -> float:
    """The drop at the design flow over an orifice, (3.17) the other way round [Pa]."""
    return p["density"] / 2.0 * (p["design_flow"] / (p[discharge] * area)) ** 2


def _of(rows: Records, stem: bool) -> dict[str, FloatArray]:
    """Every dimension of designs given as `PARAMETER_ROW`, a column each."""
    g = np.zeros(len(rows), dtype=GEOMETRY)
    for i in range(len(rows)):
        derive(rows[i : i + 1], 1.0, int(stem), g[i : i + 1])
    p = {name: rows[name] for name in PARAMETERS}
    port, offset, width = g["port_radius"], g["port_offset"], p["groove_width"]
    chord = np.sqrt(np.maximum(port**2 - offset**2, 0.0))
    return {
        "spool_diameter": 2.0 * p["spool_radius"],
        "stem_diameter": 2.0 * g["stem_radius"],
        "port_diameter": 2.0 * port,
        "fixed_orifice_diameter_1": 2.0 * np.sqrt(g["fixed_area_1"] / math.pi),
        "fixed_orifice_diameter_2": 2.0 * np.sqrt(g["fixed_area_2"] / math.pi),
        "groove_depth": math.sqrt(3.0) / 2.0 * width,
        "groove_arc": p["spool_radius"] * p["groove_angle"],
        "port_opening": port - offset,
        "port_offset": offset,
        "stop_position": g["stop_position"],
        "stroke": 2.0 * g["stop_position"],
        "land_length": p["land_length_ratio"] * p["land_distance"],
        "spool_length": g["spool_length"],
        "spool_end_area": g["end_area"],
        "fixed_area_1": g["fixed_area_1"],
        "fixed_area_2": g["fixed_area_2"],
        "port_area": math.pi * port**2,
        "port_open_area": port**2 * np.arccos(offset / port) - offset * chord,
        "groove_area": g["groove_area"],
        "end_volume": g["end_volume"],
        "chamber_volume": g["chamber_volume"],
        "spool_mass": g["mass"],
        **{name: p[name] for name in (*_AS_GIVEN, "radial_clearance", "groove_angle")},
        **_drawn(p, g["spool_length"]),
    }


def _drawn(p: Mapping[str, FloatArray], spool_length: FloatArray) -> dict[str, FloatArray]:
    """How the lands lie on the spool, and the corners of a groove in its cross-section."""
    lands = p["land_length_ratio"] * p["land_distance"]
    outer = np.minimum(2.0 * p["land_distance"], lands / 2.0)
    chamber = np.minimum(p["chamber_length"], (spool_length - lands) / 2.0)
    half = np.minimum(p["groove_angle"], math.pi) / 2.0
    depth = math.sqrt(3.0) / 2.0 * p["groove_width"]
    return {
        "drawn_outer_land": outer,
        "drawn_distance": outer / 2.0,
        "drawn_middle_land": lands - 2.0 * outer,
        "drawn_chamber": chamber,
        "drawn_stem": (spool_length - lands) / 2.0 - chamber,
        "groove_rise": p["spool_radius"] * np.sin(half),
        "groove_run": p["spool_radius"] * np.cos(half),
        "groove_depth_rise": depth * np.sin(half),
        "groove_depth_run": depth * np.cos(half),
    }
