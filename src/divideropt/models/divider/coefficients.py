"""From parameters and inputs by name to the records that the compiled functions read."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from divideropt.models.divider.coefficient_kernels import apply_span, prepare
from divideropt.models.divider.formulations import Formulation
from divideropt.models.divider.geometry import Geometry, geometry_of, parameter_row
from divideropt.models.divider.pilot import Groove, groove_of, leakage_sign
from divideropt.models.divider.record import COEFFICIENTS, GEOMETRY, OPTIONS, RULES, SPAN, Design, Records, blank
from divideropt.models.divider.scenario import Inputs, Scenario, Span


@dataclass(frozen=True)
class Valve:
    """One design in one formulation: what its records have in common.

    Attributes:
        parameters: Every parameter by name, SI.
        formulation: Which reading of the valve.
        row: The parameters, `PARAMETER_ROW`, shape (1,).
        derived: What they make, `GEOMETRY`, shape (1,).
    """

    parameters: Mapping[str, float]
    formulation: Formulation
    row: Records
    derived: Records
    _blank: Design

    @classmethod
    def of(cls, parameters: Mapping[str, float], formulation: Formulation) -> "Valve":
        """Derive geometry and groove."""
        row = parameter_row(parameters)
        derived, design = blank(GEOMETRY), blank(COEFFICIENTS)
        prepare(row, options_record(formulation), derived, design)
        return cls(parameters, formulation, row, derived, design)

    @property
    def geometry(self) -> Geometry:
        """What the parameters make."""
        return geometry_of(self.derived)

    @property
    def groove(self) -> Groove:
        """The pilot groove."""
        return groove_of(self.derived)

    def under(self, inputs: Inputs, sized_for: float | None = None) -> Design:
        """Return the record under inputs that stay.

        Args:
            inputs: The inputs.
            sized_for: Source flow for which the load orifices are sized [m^3/s]; the inputs' own if not given.

        Returns:
            `COEFFICIENTS`, shape (1,).
        """
        return self.over(Span(0.0, 0.0, inputs, inputs, -1), inputs.source_flow if sized_for is None else sized_for)

    def over(self, span: Span, sized_for: float) -> Design:
        """Return the record over a stretch of time.

        Args:
            span: The inputs, and how they move.
            sized_for: Source flow for which the load orifices are sized [m^3/s].

        Returns:
            `COEFFICIENTS`, shape (1,).
        """
        design = self._blank.copy()
        apply_span(self.row, span_records([span]), 0, sized_for, design)
        return design


def options_record(formulation: Formulation) -> Records:
    """Return `OPTIONS` of a formulation, shape (1,)."""
    names = [name for name in OPTIONS.names or () if name != "leakage_sign"]
    values = {name: float(getattr(formulation, name)) for name in names}
    values["leakage_sign"] = leakage_sign(formulation)
    return np.array([tuple(values[name] for name in OPTIONS.names or ())], dtype=OPTIONS)


def span_records(spans: Sequence[Span]) -> Records:
    """Return `SPAN` of the stretches of a scenario, shape (p,)."""
    rows = [
        (span.begin, span.end, span.event, span.moving, *_flat(span.inputs), *_flat(span.final_inputs))
        for span in spans
    ]
    return np.array(rows, dtype=SPAN)


def rules_record(scenario: Scenario) -> Records:
    """Return `RULES` of a scenario, shape (1,)."""
    values = (
        scenario.source_flow,
        scenario.settled,
        len(scenario.events),
        scenario.last_event_time,
        scenario.end_time,
        scenario.accumulation_time,
    )
    return np.array([values], dtype=RULES)


def _flat(inputs: Inputs) -> tuple[float, float, float, float]:
    return inputs.source_flow, inputs.spool_position, *inputs.load_pressures
