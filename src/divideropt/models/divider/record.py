"""The record that the compiled equations read: everything one design and the inputs of one phase fix."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

COEFFICIENTS = np.dtype(
    (
        np.record,
        [
            ("source_gain", "f8"),  # β/Vs
            ("chamber_gain", "f8"),  # β/Va
            ("load_gain", "f8"),  # β/VL
            ("bulk_modulus", "f8"),
            ("end_volume", "f8"),  # V1o = V2o
            ("end_area", "f8"),  # A
            ("mass", "f8"),
            ("viscous_friction", "f8"),  # Bf
            ("coulomb_friction", "f8"),  # Fc
            ("fixed_1", "f8"),  # Cdo Ao1 √(2/ρ)
            ("fixed_2", "f8"),
            ("variable", "f8"),  # Cdv √(2/ρ), times an area
            ("load_1", "f8"),  # CdL AL1 √(2/ρ): the flow that makes the load's pressure, over its root
            ("load_2", "f8"),
            ("load_flow", "f8"),  # that flow: half the source flow for which the loads are sized
            ("transient", "f8"),  # Ld Cdv √(2ρ), times a width
            ("port_radius", "f8"),  # rv
            ("port_offset", "f8"),  # d0
            ("stop_position", "f8"),  # x_max
            ("rim_thickness", "f8"),
            ("seal_leakage", "f8"),  # Cb3
            ("source_flow", "f8"),  # Qs
            ("spool_position", "f8"),  # φ/φ0
            ("extra_force", "f8"),  # on the spool, beside those of (2.17)
            ("moving", "i8"),  # whether the inputs change over the phase, from what stands above, at these rates:
            ("begin", "f8"),  # since then [s]
            ("source_flow_rate", "f8"),
            ("spool_position_rate", "f8"),
            ("load_pressure_1", "f8"),  # at the beginning
            ("load_pressure_2", "f8"),
            ("load_pressure_1_rate", "f8"),
            ("load_pressure_2_rate", "f8"),
            ("groove_conductance", "f8"),  # b⁴/(185 μ r √c)
            ("groove_length", "f8"),  # √c
            ("groove_leakage", "f8"),  # r δ³/(6 μ h)
            ("groove_angle", "f8"),  # φ0
            ("entrance_loss", "f8"),  # K ρ/(2 a²) at the supply's end of a groove of area a, over a squared flow
            ("exit_loss", "f8"),  # at the flow chamber's end
            ("pilot", "i8"),
            ("leakage_sign", "f8"),  # of side 2
            ("pilot_bypass", "f8"),  # 1, or 0 where the grooves' flow is left out of the balances
            ("pilot_1", "f8", (3, 3)),  # folded at `spool_position`, or as it moves
            ("pilot_2", "f8", (3, 3)),
            ("arc_holes", "f8"),
            ("chord_holes", "f8"),
            ("rim_holes", "f8"),
            ("orifice_law", "i8"),
            ("port_range", "i8"),
            ("stop", "i8"),
            ("pressure_floor", "i8"),
        ],
    )
)
"""What the kernel reads: one design between two events, SI."""

Design = NDArray[np.record]
"""`COEFFICIENTS` of one design, shape (1,)."""


def record_of(values: Mapping[str, float]) -> Design:
    """Make a record.

    Args:
        values: Of the fields by name; those that are not given are 0.

    Returns:
        `COEFFICIENTS`, shape (1,).
    """
    blank = [np.zeros(shape) if shape else 0 for shape in _SHAPES]
    row = tuple(values.get(name, empty) for name, empty in zip(_NAMES, blank, strict=True))
    return np.array([row], dtype=COEFFICIENTS)


_NAMES = COEFFICIENTS.names or ()
_SHAPES = [COEFFICIENTS[name].shape for name in _NAMES]
