"""The records in which designs, formulations and scenarios come to the compiled functions, all SI."""

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from divideropt.models.divider.parameters import PARAMETERS

PARAMETER_ROW = np.dtype((np.record, [(name, "f8") for name in PARAMETERS]))
"""A design: a row of a batch, its columns by name."""

GEOMETRY = np.dtype(
    (
        np.record,
        [
            ("viscosity", "f8"),
            ("stem_radius", "f8"),
            ("end_area", "f8"),
            ("mass", "f8"),
            ("spool_length", "f8"),
            ("viscous_friction", "f8"),
            ("fixed_area_1", "f8"),
            ("fixed_area_2", "f8"),
            ("port_radius", "f8"),
            ("port_offset", "f8"),
            ("stop_position", "f8"),
            ("end_volume", "f8"),
            ("chamber_volume", "f8"),
            ("seal_leakage", "f8"),
            ("open_drop", "f8"),
            ("groove_length", "f8"),  # √c
            ("groove_conductance", "f8"),  # b⁴/(185 μ r √c)
            ("groove_leakage", "f8"),  # r δ³/(6 μ h)
            ("groove_angle", "f8"),  # φ0
            ("groove_area", "f8"),
            ("groove_diameter", "f8"),  # hydraulic
        ],
    )
)
"""What a design's dimensions make; `Geometry` and `Groove` say what each is."""

OPTIONS = np.dtype(
    (
        np.record,
        [
            ("pilot", "i8"),
            ("leakage_sign", "f8"),  # of side 2
            ("arc_holes", "f8"),
            ("chord_holes", "f8"),
            ("rim_holes", "f8"),
            ("stem", "i8"),
            ("end_seals", "i8"),
            ("transient_force", "i8"),
            ("orifice_law", "i8"),
            ("port_range", "i8"),
            ("stop", "i8"),
            ("pressure_floor", "i8"),
            ("pilot_bypass", "f8"),
            ("groove_loss", "i8"),
        ],
    )
)
"""A formulation; `Formulation` says what each is."""

RULES = np.dtype(
    (
        np.record,
        [
            ("sized_for", "f8"),  # source flow for which the load orifices are sized
            ("settled", "i8"),  # whether the response begins at rest
            ("events", "i8"),
            ("last_event_time", "f8"),
            ("end_time", "f8"),
            ("accumulation_time", "f8"),
        ],
    )
)
"""What a scenario says beside its stretches; `Scenario` says what each is."""

SPAN = np.dtype(
    (
        np.record,
        [
            ("begin", "f8"),
            ("end", "f8"),
            ("event", "i8"),
            ("moving", "i8"),
            ("source_flow", "f8"),
            ("spool_position", "f8"),
            ("load_pressure_1", "f8"),
            ("load_pressure_2", "f8"),
            ("final_source_flow", "f8"),
            ("final_spool_position", "f8"),
            ("final_load_pressure_1", "f8"),
            ("final_load_pressure_2", "f8"),
        ],
    )
)
"""A stretch of a scenario; `Span` says what each is."""

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

Records = NDArray[np.record]
"""Of any of these, shape (n,)."""


Design = Records
"""`COEFFICIENTS` of one design, shape (1,)."""


def blank(dtype: np.dtype[Any], count: int = 1) -> Records:
    """Return so many records of zeros."""
    return np.zeros(count, dtype=dtype)


def parameter_rows(designs: NDArray[np.float64]) -> Records:
    """Return designs, shape (n, d), columns as in `PARAMETERS`, as `PARAMETER_ROW`, shape (n,)."""
    return cast(Records, np.ascontiguousarray(designs, dtype=np.float64).view(PARAMETER_ROW)[:, 0])
