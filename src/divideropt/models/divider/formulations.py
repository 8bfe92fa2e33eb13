"""Where the formulations of the one valve differ: everything else is the same code.

The thesis's printed equations, its appendix and its code disagree; `conservative` is the physics, corrected,
and `listing` is Appendix C.3 as it ran.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from types import MappingProxyType


class OrificeLaw(IntEnum):
    """How an orifice passes a small or reversed pressure drop."""

    SMOOTH_ROOT = 0
    """Exact root from 100 Pa on, an odd C¹ polynomial below."""
    SIGNED_ROOT = 1
    """sign(Δp)·sqrt(abs Δp), with its infinite slope at 0."""


class PortRange(IntEnum):
    """What a port does where the spool has left it."""

    OWN = 0
    """Each port is shut or full beyond its own range; its rim has no chord there."""
    FIRST = 1
    """The spool is held in port 1's range for both ports (C.3): port 2's arccosine may give NaN."""


class Stop(IntEnum):
    """What ends the spool's stroke."""

    CONTACT = 0
    """A stiff spring and damper."""
    FROZEN = 1
    """The position stands still beyond the stop while the velocity goes on growing (C.3)."""
    NONE = 2
    """Nothing: the spool moves on."""


class PressureFloor(IntEnum):
    """What sees max(p, 0) instead of a negative pressure."""

    FLOWS = 0
    """The flow laws."""
    EVERYTHING = 1
    """Flow laws and forces (C.3)."""


@dataclass(frozen=True)
class Formulation:
    """One reading of the valve.

    Attributes:
        hyperbolic_pilot: Pilot groove from the corrected continuity equation (cosh and sinh), or from (A.22)-
            (A.42) as coded (cos and sin without the particular solution).
        mirrored_leakage: Whether the leakage of side 2 mirrors side 1; C.3 has a minus there (a slip).
        arc_holes: Holes counted in the first term of (2.15).
        chord_holes: Holes counted in its second term; C.3 forgets them (operator precedence).
        rim_holes: Holes counted in (2.18).
        orifice_law: See `OrificeLaw`.
        port_range: See `PortRange`.
        stop: See `Stop`.
        pressure_floor: See `PressureFloor`.
    """

    hyperbolic_pilot: bool
    mirrored_leakage: bool
    arc_holes: int
    chord_holes: int
    rim_holes: int
    orifice_law: OrificeLaw
    port_range: PortRange
    stop: Stop
    pressure_floor: PressureFloor


FORMULATIONS: Mapping[str, Formulation] = MappingProxyType(
    {
        "conservative": Formulation(
            hyperbolic_pilot=True,
            mirrored_leakage=True,
            arc_holes=2,
            chord_holes=2,
            rim_holes=2,
            orifice_law=OrificeLaw.SMOOTH_ROOT,
            port_range=PortRange.OWN,
            stop=Stop.CONTACT,
            pressure_floor=PressureFloor.FLOWS,
        ),
        "listing": Formulation(
            hyperbolic_pilot=False,
            mirrored_leakage=False,
            arc_holes=2,
            chord_holes=1,
            rim_holes=2,
            orifice_law=OrificeLaw.SIGNED_ROOT,
            port_range=PortRange.FIRST,
            stop=Stop.FROZEN,
            pressure_floor=PressureFloor.EVERYTHING,
        ),
    }
)
"""The formulations by the name a campaign gives."""
