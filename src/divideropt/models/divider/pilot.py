"""The pilot stage: flows of the grooves on one land, linear in the three pressures around it.

`docs/model/pilot.md` derives them again: the continuity equation (A.1) has its two leakage terms
swapped, so the corrected profile along a groove is hyperbolic where the thesis has sines and cosines. Being
linear in (Ps, Pa, Pb), the stage is folded into coefficients once a design, and the right-hand side of the
equations of motion needs none of it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider.formulations import Formulation, Pilot

GROOVE_FACTOR = 185.0
"""Laminar flow through an equilateral triangle of side b: Q = -b⁴/(185 μ) dP/dl, (A.3)."""


@dataclass(frozen=True)
class PilotSide:
    """Flows of one side, each a row of coefficients for (Ps, Pa, Pb) [m^3/(s Pa)].

    Attributes:
        inlet: Qci, from the supply into one groove.
        arriving: Qc1o or Qc2o, arriving at the tap, one groove.
        tap: Qb, from one groove to the end chamber.
        outlet: Qao, from one groove to the flow chamber.
        end_leakage: Qlb, end chamber to both grooves, over the land.
        chamber_leakage: Qla, both grooves to flow chamber, over the land.
    """

    inlet: FloatArray
    arriving: FloatArray
    tap: FloatArray
    outlet: FloatArray
    end_leakage: FloatArray
    chamber_leakage: FloatArray

    def net(self) -> FloatArray:
        """What both grooves add to the supply, the flow chamber and the end chamber, shape (3, 3)."""
        return np.array(
            [
                -2.0 * self.inlet,
                2.0 * self.outlet + self.chamber_leakage,
                2.0 * self.tap - self.end_leakage,
            ]
        )


def pilot_sides(
    p: Mapping[str, float], viscosity: float, spool_position: float, formulation: Formulation
) -> tuple[PilotSide, PilotSide]:
    """Fold the pilot stage into coefficients.

    Args:
        p: Every parameter by name, SI.
        viscosity: Dynamic viscosity [Pa s].
        spool_position: φ/φ0, strictly between 0 and 1.
        formulation: Which reading of the valve.

    Returns:
        Side 1, whose tap lies φ from the supply, and side 2, its mirror image.
    """
    groove = _Groove.of(p, viscosity)
    near = spool_position * groove.angle
    far = groove.angle - near
    if formulation.pilot is Pilot.HYPERBOLIC:
        return _hyperbolic_side(groove, near, far), _hyperbolic_side(groove, far, near)
    particular = formulation.pilot is Pilot.TRIGONOMETRIC
    sign_2 = 1.0 if formulation.mirrored_leakage else -1.0
    return (
        _trigonometric_side(groove, near, far, particular, 1.0),
        _trigonometric_side(groove, far, near, particular, sign_2),
    )


@dataclass(frozen=True)
class _Groove:
    """Constants of one groove: angle φ0, √c of (A.13), G of section 2, and the leakage's rδ³/(6μh)."""

    angle: float
    length: float
    conductance: float
    leakage: float

    @classmethod
    def of(cls, p: Mapping[str, float], viscosity: float) -> "_Groove":
        r, b, h, delta = p["spool_radius"], p["groove_width"], p["land_distance"], p["radial_clearance"]
        length = math.sqrt(6 * b**4 * h / (GROOVE_FACTOR * r**2 * delta**3))
        return cls(
            angle=p["groove_angle"],
            length=length,
            conductance=b**4 / (GROOVE_FACTOR * viscosity * r * length),
            leakage=r * delta**3 / (6 * viscosity * h),
        )


def _hyperbolic_side(groove: _Groove, near: float, far: float) -> PilotSide:
    """Corrected profile; `near` and `far` are the angles from the tap to the supply and to the outlet.

    The solutions of c P'' = P - (Pa + Pb)/2, in half angles, which neither overflow nor cancel:
    coth v ∓ 1/sinh v are tanh(v/2) and coth(v/2).
    """
    tanh_near = math.tanh(near / groove.length / 2)
    tanh_far = math.tanh(far / groove.length / 2)
    half = groove.conductance / 2
    to_supply_end = half / tanh_near * _difference(0, 2)
    to_supply_chamber = half * tanh_near * _difference(0, 1)
    outlet = half / tanh_far * _difference(2, 1)
    across = groove.leakage * groove.angle / 2 * _difference(2, 1)
    along = groove.leakage * groove.length * tanh_near * _difference(0, 1)
    arriving = to_supply_end - to_supply_chamber
    return PilotSide(
        inlet=to_supply_end + to_supply_chamber,
        arriving=arriving,
        tap=arriving - outlet,
        outlet=outlet,
        end_leakage=across - along,
        chamber_leakage=across + along,
    )


def _trigonometric_side(
    groove: _Groove, near: float, far: float, particular: bool, leakage_sign: float
) -> PilotSide:
    """(2.20)–(2.33), (2.42) and their mirror images, end flows as (A.29), (A.30): about the chambers' mean pressure.

    Without the particular solution it is (A.22)–(A.25), (A.31)–(A.38) about zero, as coded in C.3.
    """
    sin_near, cos_near = math.sin(near / groove.length), math.cos(near / groove.length)
    sin_far, cos_far = math.sin(far / groove.length), math.cos(far / groove.length)
    mean = np.array([0.0, 0.5, 0.5]) if particular else np.zeros(3)
    ps, pa, pb = np.eye(3) - mean
    at_supply = (pb - ps * cos_near) / sin_near  # Cd1, Cb2
    at_outlet = (pb - pa * cos_far) / sin_far  # Cb1, Cd2
    arriving = groove.conductance * (ps * sin_near - at_supply * cos_near)
    leaving = groove.conductance * (at_outlet * cos_far - pa * sin_far)
    across = groove.leakage * groove.angle / 2 * (pb - pa)
    along = (
        groove.leakage
        * groove.length
        * (-ps * sin_near + at_supply * (cos_near - 1) - pa * sin_far - at_outlet * (1 - cos_far))
    )
    return PilotSide(
        inlet=-groove.conductance * at_supply,
        arriving=arriving,
        tap=arriving - leaving,
        outlet=groove.conductance * at_outlet,
        end_leakage=across + leakage_sign * along,
        chamber_leakage=across - along,
    )


def _difference(plus: int, minus: int) -> FloatArray:
    """Coefficients of one pressure less another, in the order (Ps, Pa, Pb)."""
    row = np.zeros(3)
    row[plus], row[minus] = 1.0, -1.0
    return row
