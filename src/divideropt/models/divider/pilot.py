"""The pilot stage: flows of the grooves on one land, linear in the three pressures around it.

`docs/model/pilot.md` derives them again: the continuity equation (A.1) has its two leakage terms swapped, so the
corrected profile along a groove is hyperbolic where the thesis has sines and cosines. Being linear in (Ps, Pa, Pb),
the stage is folded into coefficients once a design, and the right-hand side of the equations of motion needs none of
it, unless the spool is being turned. The losses at a groove's ends, an option, are not linear: the kernel adds them.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider.coefficient_kernels import derive
from divideropt.models.divider.formulations import Formulation
from divideropt.models.divider.geometry import parameter_row
from divideropt.models.divider.groove_kernels import fold_side, gather
from divideropt.models.divider.record import GEOMETRY, Records, blank


@dataclass(frozen=True)
class Groove:
    """What the flow along one groove depends on.

    Attributes:
        length: √c [rad], over which the pressure comes near the mean of the chambers, (A.13).
        conductance: b⁴/(185 μ r √c) [m^3/(s Pa)].
        leakage: r δ³/(6 μ h), of both grooves over an angle of 1 [m^3/(s Pa)].
        angle: φ0 [rad].
        area: Cross-section a of the triangle [m^2].
        hydraulic_diameter: Four times that over the perimeter [m].
    """

    length: float
    conductance: float
    leakage: float
    angle: float
    area: float
    hydraulic_diameter: float

    @classmethod
    def of(cls, p: Mapping[str, float]) -> "Groove":
        """Derive it from every parameter by name, SI."""
        derived = blank(GEOMETRY)
        derive(parameter_row(p), 1.0, 1, derived)
        return groove_of(derived)


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
        rows = (self.inlet, self.arriving, self.tap, self.outlet, self.end_leakage, self.chamber_leakage)
        net = np.empty((3, 3))
        gather(np.array(rows), 1.0, net)
        return net


def groove_of(derived: Records) -> Groove:
    """Return the groove of a record of `GEOMETRY`, shape (1,)."""
    g = derived[0]
    return Groove(
        length=float(g.groove_length),
        conductance=float(g.groove_conductance),
        leakage=float(g.groove_leakage),
        angle=float(g.groove_angle),
        area=float(g.groove_area),
        hydraulic_diameter=float(g.groove_diameter),
    )


def pilot_sides(
    p: Mapping[str, float], spool_position: float, formulation: Formulation
) -> tuple[PilotSide, PilotSide]:
    """Fold the pilot stage into coefficients.

    Args:
        p: Every parameter by name, SI.
        spool_position: φ/φ0, strictly between 0 and 1.
        formulation: Which reading of the valve.

    Returns:
        Side 1, whose tap lies φ from the supply, and side 2, its mirror image.
    """
    groove = Groove.of(p)
    near = spool_position * groove.angle
    far = groove.angle - near

    def side(near: float, far: float, sign: float) -> PilotSide:
        flows = fold_side(formulation.pilot, groove.conductance, groove.length, groove.leakage, near, far, sign)
        return PilotSide(*flows)

    return side(near, far, 1.0), side(far, near, leakage_sign(formulation))


def leakage_sign(formulation: Formulation) -> float:
    """Sign of the profile's part in the end leakage of side 2."""
    return 1.0 if formulation.mirrored_leakage else -1.0
