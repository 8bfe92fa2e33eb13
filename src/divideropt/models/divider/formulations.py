"""Where the formulations of the one valve differ: everything else is the same code.

The thesis's printed equations, its appendix and its code disagree; `conservative` is the physics, corrected,
`text` is Chapter 2 as printed, and `listing` is Appendix C.3 as it ran.
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
    """sign(Δp)·sqrt(abs Δp), with its infinite slope at 0 (C.3)."""
    TANH_ROOT = 2
    """tanh(Δp/p_tan)·sqrt(abs Δp), (2.9)."""


class Pilot(IntEnum):
    """Which solution of the groove's continuity equation gives the pilot flows."""

    HYPERBOLIC = 0
    """Of the corrected equation: cosh and sinh about the mean pressure of the two chambers."""
    TRIGONOMETRIC = 1
    """Of (A.1) as printed: cos and sin about that mean, (2.20)-(2.33), (2.42)-(2.45)."""
    HOMOGENEOUS = 2
    """The same without the particular solution: about zero, (A.22)-(A.25), (A.39)-(A.42), as coded in C.3."""


class PortRange(IntEnum):
    """What a port does where the spool has left it."""

    OWN = 0
    """Each port is shut or full beyond its own range; its rim has no chord there."""
    FIRST = 1
    """The spool is held in port 1's range for both ports (C.3): port 2's arccosine may give NaN."""
    PRINTED = 2
    """(2.15), (2.18) as printed: not a number where the spool has left a port."""


class Stop(IntEnum):
    """What ends the spool's stroke."""

    CONTACT = 0
    """A stiff spring and damper."""
    FROZEN = 1
    """The position stands still beyond the stop while the velocity goes on growing (C.3)."""
    NONE = 2
    """Nothing: the spool moves on (the printed equations have none)."""


class PressureFloor(IntEnum):
    """What sees max(p, 0) instead of a negative pressure."""

    FLOWS = 0
    """The flow laws."""
    EVERYTHING = 1
    """Flow laws and forces (C.3)."""
    NOTHING = 2
    """Nothing: pressures are as printed."""


@dataclass(frozen=True)
class Formulation:
    """One reading of the valve.

    Attributes:
        pilot: See `Pilot`.
        mirrored_leakage: Whether the leakage of side 2 mirrors side 1; C.3 has a minus there (a slip).
        arc_holes: Holes counted in the first term of (2.15).
        chord_holes: Holes counted in its second term; C.3 forgets them (operator precedence).
        rim_holes: Holes counted in (2.18).
        stem: Whether the spool end's area is less that of the stem; (3.13) as printed is not.
        end_seals: Whether the end seals leak to tank (C.3).
        transient_force: Whether the jets brake the spool over the damping length (C.3).
        pilot_bypass: Whether what flows through the grooves is taken from the source and reaches the flow chambers;
            off only to see its share of an error.
        groove_loss: Whether a groove's entrance and exit take `groove_loss_factor` velocity heads off its drop; the
            thesis's assumption 5 of section 2.3 is that they do not.
        orifice_law: See `OrificeLaw`.
        port_range: See `PortRange`.
        stop: See `Stop`.
        pressure_floor: See `PressureFloor`.
    """

    pilot: Pilot
    mirrored_leakage: bool
    arc_holes: int
    chord_holes: int
    rim_holes: int
    stem: bool
    end_seals: bool
    transient_force: bool
    orifice_law: OrificeLaw
    port_range: PortRange
    stop: Stop
    pressure_floor: PressureFloor
    pilot_bypass: bool = True
    groove_loss: bool = False


FORMULATIONS: Mapping[str, Formulation] = MappingProxyType(
    {
        "conservative": Formulation(
            pilot=Pilot.HYPERBOLIC,
            mirrored_leakage=True,
            arc_holes=2,
            chord_holes=2,
            rim_holes=2,
            stem=True,
            end_seals=True,
            transient_force=True,
            orifice_law=OrificeLaw.SMOOTH_ROOT,
            port_range=PortRange.OWN,
            stop=Stop.CONTACT,
            pressure_floor=PressureFloor.FLOWS,
        ),
        "text": Formulation(
            pilot=Pilot.TRIGONOMETRIC,
            mirrored_leakage=True,
            arc_holes=1,
            chord_holes=1,
            rim_holes=1,
            stem=False,
            end_seals=False,
            transient_force=False,
            orifice_law=OrificeLaw.TANH_ROOT,
            port_range=PortRange.PRINTED,
            stop=Stop.NONE,
            pressure_floor=PressureFloor.NOTHING,
        ),
        "listing": Formulation(
            pilot=Pilot.HOMOGENEOUS,
            mirrored_leakage=False,
            arc_holes=2,
            chord_holes=1,
            rim_holes=2,
            stem=True,
            end_seals=True,
            transient_force=True,
            orifice_law=OrificeLaw.SIGNED_ROOT,
            port_range=PortRange.FIRST,
            stop=Stop.FROZEN,
            pressure_floor=PressureFloor.EVERYTHING,
        ),
    }
)
"""The formulations by the name a campaign gives."""
