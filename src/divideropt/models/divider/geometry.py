"""Dimensions and coefficients derived from the parameters: (3.13)–(3.22), as coded in C.1."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

STEEL_DENSITY = 7870.0
"""Density of the spool [kg/m^3], from C.1."""

STROKE_MARGIN = 1.3
"""Stop position over the position at which port 1 is just fully open, from C.1."""


@dataclass(frozen=True)
class Geometry:
    """What one set of parameters makes.

    Attributes:
        viscosity: Dynamic viscosity μ [Pa s].
        stem_radius: r_stem [m].
        end_area: Spool end area A [m^2], (3.13) less the stem where the formulation has one.
        mass: Spool mass m [kg], (3.14).
        spool_length: L_T [m].
        viscous_friction: B_f [N s/m], (3.16).
        fixed_area_1: Ao1 [m^2], (3.17).
        fixed_area_2: Ao2 [m^2].
        port_radius: r_v [m], (3.18): for one hole, though there are two, as the prototype was drawn.
        port_offset: d_0 [m], (3.19).
        stop_position: x_max [m].
        end_volume: V_1o = V_2o [m^3], (3.20), (3.21).
        chamber_volume: V_a [m^3], (3.22).
        seal_leakage: C_b3 = C_b4 [m^3/(s Pa)], C.1.
        open_drop: Drop at the design flow with the ports fully open, both holes counted [Pa].
    """

    viscosity: float
    stem_radius: float
    end_area: float
    mass: float
    spool_length: float
    viscous_friction: float
    fixed_area_1: float
    fixed_area_2: float
    port_radius: float
    port_offset: float
    stop_position: float
    end_volume: float
    chamber_volume: float
    seal_leakage: float
    open_drop: float


def derive_geometry(p: Mapping[str, float], *, holes: int, stem: bool = True) -> Geometry:
    """Derive the geometry.

    Args:
        p: Every parameter by name, SI.
        holes: Holes a port has, as the formulation counts them; enters `open_drop` alone.
        stem: Whether the spool end's area is less that of the stem.

    Returns:
        The derived dimensions.
    """
    r = p["spool_radius"]
    viscosity = p["kinematic_viscosity"] * p["density"]
    land_length = p["land_length_ratio"] * p["land_distance"]
    spool_length = land_length / p["land_fraction"]
    stem_radius = r * p["stem_ratio"]
    end_area = math.pi * (r**2 - (stem_radius**2 if stem else 0.0))
    drop, fixed_drop = p["total_pressure_drop"], p["fixed_drop_ratio"] * p["total_pressure_drop"]
    fixed_area = _orifice_area(p["design_flow"], p["fixed_discharge"], p["density"], fixed_drop)
    share_1 = 2 * p["fixed_area_ratio"] / (1 + p["fixed_area_ratio"])
    port_area = _orifice_area(p["design_flow"], p["variable_discharge"], p["density"], drop - fixed_drop)
    port_radius = math.sqrt(port_area / math.pi)
    port_offset = port_radius * (1 - 2 * p["centred_opening"])
    stop_position = STROKE_MARGIN * (port_offset + port_radius)
    return Geometry(
        viscosity=viscosity,
        stem_radius=stem_radius,
        end_area=end_area,
        mass=p["mass_ratio"] * r**2 * math.pi * spool_length * STEEL_DENSITY,
        spool_length=spool_length,
        viscous_friction=2 * math.pi * r * land_length * viscosity / p["radial_clearance"],
        fixed_area_1=fixed_area * share_1,
        fixed_area_2=fixed_area * (2 - share_1),
        port_radius=port_radius,
        port_offset=port_offset,
        stop_position=stop_position,
        end_volume=(p["end_clearance"] + stop_position) * end_area,
        chamber_volume=math.pi * (r**2 - (r / 2) ** 2) * p["chamber_length"],
        seal_leakage=stem_radius * math.pi * p["radial_clearance"] ** 3 / (6 * viscosity * p["seal_length"]),
        open_drop=fixed_drop + (drop - fixed_drop) / holes**2,
    )


def _orifice_area(flow: float, discharge: float, density: float, drop: float) -> float:
    """Area [m^2] that passes a flow [m^3/s] at a drop [Pa], (3.17)."""
    return flow / (discharge * math.sqrt(2 / density * drop))
