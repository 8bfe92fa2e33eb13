"""Dimensions and coefficients derived from the parameters: (3.13)–(3.22), as coded in C.1."""

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from divideropt.models.divider.coefficient_kernels import derive
from divideropt.models.divider.record import GEOMETRY, PARAMETER_ROW, Records, blank


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
    derived = blank(GEOMETRY)
    derive(parameter_row(p), float(holes), int(stem), derived)
    return geometry_of(derived)


def geometry_of(derived: Records) -> Geometry:
    """Return the geometry of a record of `GEOMETRY`, shape (1,)."""
    return Geometry(**{field.name: float(derived[field.name][0]) for field in fields(Geometry)})


def parameter_row(p: Mapping[str, float]) -> Records:
    """Return every parameter, given by name, as `PARAMETER_ROW`, shape (1,)."""
    return np.array([tuple(p[name] for name in PARAMETER_ROW.names or ())], dtype=PARAMETER_ROW)
