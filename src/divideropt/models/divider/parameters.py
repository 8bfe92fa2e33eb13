"""The divider's parameters and the thesis's parameter sets (Appendix B, Table 3.3)."""

import math
from collections.abc import Mapping
from types import MappingProxyType

from divideropt.models.base import Domain, Parameter

_POSITIVE = Domain(lower=0.0, open_lower=True)
_NOT_NEGATIVE = Domain(lower=0.0)
_OPEN_UNIT = Domain(lower=0.0, upper=1.0, open_lower=True, open_upper=True)
_BASE = "Appendix B.1"

_TABLE = (
    Parameter("spool_radius", "m", "r", "radius of the spool's lands", 8e-3, _POSITIVE, _BASE),
    Parameter("groove_width", "m", "b", "side of the pilot groove's triangle", 1e-3, _POSITIVE, _BASE),
    Parameter(
        "total_pressure_drop",
        "Pa",
        "ΔPt",
        "drop over fixed and fully open port at the design flow, by which the ports are sized",
        3e6,
        _POSITIVE,
        _BASE,
    ),
    Parameter("fixed_drop_ratio", "", "ΔPo/ΔPt", "share of that drop at the fixed orifice", 0.5, _OPEN_UNIT, _BASE),
    Parameter("centred_opening", "", "FO", "open fraction of a port, spool centred", 0.5, _OPEN_UNIT, _BASE),
    Parameter("radial_clearance", "m", "δ", "between spool and sleeve", 2.9e-6, _POSITIVE, _BASE),
    Parameter("rim_thickness", "m", "t_rim", "of the rim at a port's edge", 0.8e-3, _NOT_NEGATIVE, _BASE),
    Parameter(
        "stem_ratio",
        "",
        "r_stem/r",
        "stem radius over land radius",
        0.3,
        Domain(0.0, 1.0, open_upper=True),
        _BASE,
    ),
    Parameter(
        "groove_angle",
        "rad",
        "φ0",
        "angle the pilot groove covers",
        math.pi / 2,
        Domain(0.0, 2 * math.pi, open_lower=True),
        _BASE,
    ),
    Parameter("fixed_discharge", "", "Cdo", "discharge coefficient, fixed orifices", 0.61, _POSITIVE, _BASE),
    Parameter("variable_discharge", "", "Cdv", "discharge coefficient, ports", 0.61, _POSITIVE, _BASE),
    Parameter(
        "fixed_area_ratio",
        "",
        "Ao1/Ao2",
        "area of fixed orifice 1 over that of 2; their sum does not depend on it",
        1.0,
        _POSITIVE,
        "section 2.2",
    ),
    Parameter("design_flow", "m^3/s", "Qso", "flow of one branch at which it is sized", 5e-4, _POSITIVE, _BASE),
    Parameter("source_volume", "m^3", "Vs", "between pump and valve", 1e-3, _POSITIVE, _BASE),
    Parameter("end_clearance", "m", "Lv", "spool to cap at the end of its stroke", 2.5e-3, _POSITIVE, _BASE),
    Parameter("land_distance", "m", "h", "from groove to the land's edge", 5e-3, _POSITIVE, _BASE),
    Parameter("coulomb_friction", "N", "Fc", "of the spool", 0.0, _NOT_NEGATIVE, _BASE),
    Parameter("land_length_ratio", "", "L_L/h", "total land length over h", 8.0, _POSITIVE, _BASE),
    Parameter(
        "land_fraction",
        "",
        "L_L/L_T",
        "total land length over spool length",
        0.4,
        Domain(0.0, 1.0, open_lower=True),
        _BASE,
    ),
    Parameter(
        "mass_ratio",
        "",
        "M_R",
        "spool mass over that of a solid cylinder",
        0.5,
        Domain(0.0, 1.0, open_lower=True),
        _BASE,
    ),
    Parameter("chamber_length", "m", "La", "flow chamber, between the lands", 20e-3, _POSITIVE, _BASE),
    Parameter("damping_length", "m", "Ld", "of the transient flow force", 10e-3, _NOT_NEGATIVE, _BASE),
    Parameter("seal_length", "m", "Ls", "of the end seals", 5e-3, _POSITIVE, _BASE),
    Parameter("bulk_modulus", "Pa", "β", "of the fluid", 1e9, _POSITIVE, _BASE),
    Parameter("density", "kg/m^3", "ρ", "of the fluid", 900.0, _POSITIVE, _BASE),
    Parameter("kinematic_viscosity", "m^2/s", "ν", "of the fluid", 30e-6, _POSITIVE, _BASE),
    Parameter(
        "load_volume",
        "m^3",
        "VL",
        "between valve and load orifice",
        math.pi / 4 * (6e-3) ** 2 * 0.10,
        _POSITIVE,
        _BASE,
    ),
    Parameter("load_discharge", "", "CdL", "discharge coefficient, load orifices", 0.61, _POSITIVE, _BASE),
    Parameter(
        "groove_loss_factor",
        "",
        "K",
        "velocity heads lost at a pilot groove's entrance and exit, with `groove_loss: entrance` only",
        1.5,
        _NOT_NEGATIVE,
        "a sharp entrance, 0.5, and an exit, 1",
    ),
)

PARAMETERS: Mapping[str, Parameter] = MappingProxyType({p.name: p for p in _TABLE})
"""Every parameter by name, in the order of a design's columns; the defaults are Appendix B.1."""

_OPTIMISED = {
    "spool_radius": 13.3e-3,
    "groove_width": 1.35e-3,
    "total_pressure_drop": 7.91e6,
    "fixed_drop_ratio": 0.886,
    "centred_opening": 0.421,
}

PARAMETER_SETS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "thesis_base": {},
        "thesis_prototype": {**_OPTIMISED, "stem_ratio": 0.44361},
        "thesis_optimum": {**_OPTIMISED},
    }
)
"""What each named set changes in the defaults: B.1, B.2 (the drawn prototype) and Table 3.3 on B.1."""


def parameter_set(name: str) -> dict[str, float]:
    """Return every parameter of a named set, in the order of `PARAMETERS`.

    Args:
        name: A key of `PARAMETER_SETS`.

    Returns:
        The values by name, SI.
    """
    return {p.name: p.default for p in _TABLE} | dict(PARAMETER_SETS[name])
