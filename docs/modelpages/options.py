"""The formulations one option at a time: what each disagreement makes of the results."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from divideropt.models.divider import FORMULATIONS, parameter_set
from divideropt.models.divider.formulations import Pilot
from modelpages.runs import Run, run
from modelpages.tables import fixed, power, table

PARAMETERS: Mapping[str, Mapping[str, float]] = {
    "base": parameter_set("thesis_base"),
    "wide": parameter_set("thesis_base") | {"radial_clearance": 20e-6},
    "prototype": parameter_set("thesis_prototype"),
}
"""The designs of the tables: B.1, the same with the widest clearance of section 3.4, and B.2."""


@dataclass(frozen=True)
class Reading:
    """A formulation and what is changed in it.

    Attributes:
        label: In the table.
        formulation: A name of `FORMULATIONS`.
        changes: Options by name.
    """

    label: str
    formulation: str
    changes: Mapping[str, Any] = field(default_factory=dict)

    def run(self, parameters: Mapping[str, float]) -> Run:
        """Simulate a design."""
        return run(parameters, replace(FORMULATIONS[self.formulation], **self.changes))


WHOLE = tuple(Reading(f"**`{name}`**", name) for name in FORMULATIONS)

FROM_CONSERVATIVE = (
    Reading("pilot stage of Chapter 2 (sign of (A.1))", "conservative", {"pilot": Pilot.TRIGONOMETRIC}),
    Reading("pilot stage of C.3 (and no particular solution)", "conservative", {"pilot": Pilot.HOMOGENEOUS}),
    Reading("one hole in (2.15)", "conservative", {"arc_holes": 1, "chord_holes": 1}),
    Reading("one hole in the second term of (2.15)", "conservative", {"chord_holes": 1}),
    Reading("one hole in (2.18)", "conservative", {"rim_holes": 1}),
    Reading("end area π r²", "conservative", {"stem": False}),
    Reading("no end-seal leakage", "conservative", {"end_seals": False}),
    Reading("no transient force", "conservative", {"transient_force": False}),
)
"""From the physics towards the thesis."""

FROM_LISTING = (
    Reading("leakage of side 2 mirrored", "listing", {"mirrored_leakage": True}),
    Reading("particular solution put back", "listing", {"pilot": Pilot.TRIGONOMETRIC}),
    Reading("both", "listing", {"pilot": Pilot.TRIGONOMETRIC, "mirrored_leakage": True}),
    Reading("hyperbolic pilot stage", "listing", {"pilot": Pilot.HYPERBOLIC}),
    Reading("two holes in both terms of (2.15)", "listing", {"chord_holes": 2}),
    Reading("hyperbolic and two holes", "listing", {"pilot": Pilot.HYPERBOLIC, "chord_holes": 2}),
)
"""From the code as it ran towards the physics."""

HEADER = (
    "",
    "steady-state error [%]",
    "dynamic error [mL]",
    "source pressure [MPa]",
    "settling time [ms]",
    "fluid from nowhere [m³/s]",
)

ROUNDING = 1e-15
"""Of a flow [m^3/s]: a created flow below it is printed as 0."""


def options_table(readings: Sequence[Reading], design: str) -> str:
    """Tabulate readings of one design in the standard test.

    Args:
        readings: A row each.
        design: A key of `PARAMETERS`.
    """
    return table(HEADER, [[r.label, *cells(r.run(PARAMETERS[design]))] for r in readings], numbers_from=1)


def cells(found: Run) -> list[str]:
    """Write the columns of `HEADER` after the first."""
    return [
        fixed(found["steady_state_error"], 3),
        fixed(found["dynamic_error"] * 1e6, 3),
        fixed(found["source_pressure"] / 1e6, 3),
        fixed(found["settling_time"] * 1e3, 1),
        power(found.fluid_from_nowhere, 1, ROUNDING),
    ]
