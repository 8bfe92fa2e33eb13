"""The author's own study of the divider (section 3.4): which parameters he varied one at a time, and how far."""

import math
from collections.abc import Mapping
from types import MappingProxyType

THESIS_RANGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "spool_radius": (8e-3, 20e-3),
        "groove_width": (0.3e-3, 2e-3),
        "radial_clearance": (1e-6, 20e-6),
        "total_pressure_drop": (1e6, 10e6),
        "fixed_drop_ratio": (0.1, 0.99),
        "centred_opening": (0.2, 0.5),
        "rim_thickness": (0.001e-3, 2e-3),
        "coulomb_friction": (0.0, 10.0),
        "kinematic_viscosity": (15e-6, 66e-6),
        "groove_angle": (math.pi / 3, math.pi),
    }
)
"""Lower and upper end of each parameter, SI: `range_m` of changeall.m, in its order."""

THESIS_POINTS = 100
"""Points of each sweep: `nparam` of changeall.m."""

LISTING_NAMES: Mapping[str, str] = MappingProxyType(
    {
        "r": "spool_radius",
        "b": "groove_width",
        "deltaPt": "total_pressure_drop",
        "Po_Pt": "fixed_drop_ratio",
        "frac_open": "centred_opening",
        "trim": "rim_thickness",
    }
)
"""What his code calls the parameters of the sweeps that it was run for again, as in `listing_sensitivity.csv`."""
