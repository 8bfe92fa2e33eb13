"""The author's House of Quality: Tables 3.1 and 3.2, and which of our quantities each of its rows is about."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True)
class ThesisRow:
    """A criterion of the author's.

    Attributes:
        words: Its name in the tables.
        quantities: Which of ours it is, the first that a campaign asks for, else the first; none of cost.
        weight: His importance; None for his "D", a demand.
        scores: His numbers by parameter, 0 where he left a blank.
    """

    words: str
    quantities: tuple[str, ...]
    weight: float | None
    scores: Mapping[str, int]


THESIS_HOUSE: tuple[ThesisRow, ...] = (
    ThesisRow(
        "steady-state error",
        ("steady_state_error",),
        3.0,
        MappingProxyType(
            {
                "spool_radius": 4,
                "groove_width": 3,
                "radial_clearance": 4,
                "total_pressure_drop": 4,
                "fixed_drop_ratio": 2,
                "centred_opening": 1,
                "rim_thickness": 4,
            }
        ),
    ),
    ThesisRow(
        "dynamic error",
        ("dynamic_error",),
        3.0,
        MappingProxyType(
            {
                "spool_radius": 3,
                "groove_width": 3,
                "radial_clearance": 1,
                "total_pressure_drop": 4,
                "fixed_drop_ratio": 2,
                "centred_opening": 3,
                "rim_thickness": 1,
            }
        ),
    ),
    ThesisRow(
        "pressure losses",
        ("pressure_loss", "source_pressure"),
        1.0,
        MappingProxyType(
            {
                "spool_radius": 0,
                "groove_width": 1,
                "radial_clearance": 0,
                "total_pressure_drop": 4,
                "fixed_drop_ratio": 2,
                "centred_opening": 3,
                "rim_thickness": 0,
            }
        ),
    ),
    ThesisRow(
        "stability",
        ("stability_margin",),
        None,
        MappingProxyType(
            {
                "spool_radius": 4,
                "groove_width": 2,
                "radial_clearance": 1,
                "total_pressure_drop": 3,
                "fixed_drop_ratio": 1,
                "centred_opening": 1,
                "rim_thickness": 1,
            }
        ),
    ),
    ThesisRow(
        "cost",
        (),
        2.0,
        MappingProxyType(
            {
                "spool_radius": 2,
                "groove_width": 2,
                "radial_clearance": 4,
                "total_pressure_drop": 0,
                "fixed_drop_ratio": 0,
                "centred_opening": 0,
                "rim_thickness": 3,
            }
        ),
    ),
)
"""Table 3.2 for the five parameters that were optimised; the columns of clearance and rim, and the row of cost, are
Table 3.1's. The scan has lost the blanks of that table: of pressure losses ("1 1 4 2 3") Table 3.2 tells where they
were, and the row of cost ("2 2 2 4 3") is read as the weight 2 and then radius, groove width, clearance and rim,
since section 3.4 names the last two as what makes the valve dear, and orifices and openings cost nothing to
change."""

COST_EXPONENTS: Mapping[str, float] = MappingProxyType(
    {"spool_radius": 2.0, "groove_width": -1.0, "radial_clearance": -1.0, "rim_thickness": -1.0}
)
"""A judgement, which no simulation makes: the cost of the parts is taken as the sum of these powers of the
parameters, each in parts of its range's middle: material by the spool's section, and reciprocally what is harder to
make the smaller it is."""
