"""From parameters and inputs to the record that the equations of motion read."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from divideropt.models.divider.formulations import Formulation
from divideropt.models.divider.geometry import Geometry, derive_geometry
from divideropt.models.divider.groove_kernels import fold_pilot
from divideropt.models.divider.pilot import ENTRANCE_SHARE, Groove, leakage_sign
from divideropt.models.divider.record import Design, record_of
from divideropt.models.divider.scenario import Inputs, Span, load_areas


@dataclass(frozen=True)
class Valve:
    """One design in one formulation: what its records have in common.

    Attributes:
        parameters: Every parameter by name, SI.
        formulation: Which reading of the valve.
        geometry: What the parameters make.
        groove: The pilot groove.
    """

    parameters: Mapping[str, float]
    formulation: Formulation
    geometry: Geometry
    groove: Groove

    @classmethod
    def of(cls, parameters: Mapping[str, float], formulation: Formulation) -> "Valve":
        """Derive geometry and groove."""
        geometry = derive_geometry(parameters, holes=formulation.arc_holes, stem=formulation.stem)
        return cls(parameters, formulation, geometry, Groove.of(parameters))

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
        values = self._valve() | self._pilot() | self._options() | self._inputs(span, sized_for)
        design = record_of(values)
        fold_pilot(design[0].spool_position, design[0])
        return design

    def _valve(self) -> dict[str, float]:
        p, g = self.parameters, self.geometry
        root = math.sqrt(2 / p["density"])
        length = p["damping_length"] if self.formulation.transient_force else 0.0
        return {
            "source_gain": p["bulk_modulus"] / p["source_volume"],
            "chamber_gain": p["bulk_modulus"] / g.chamber_volume,
            "load_gain": p["bulk_modulus"] / p["load_volume"],
            "bulk_modulus": p["bulk_modulus"],
            "end_volume": g.end_volume,
            "end_area": g.end_area,
            "mass": g.mass,
            "viscous_friction": g.viscous_friction,
            "coulomb_friction": p["coulomb_friction"],
            "fixed_1": p["fixed_discharge"] * g.fixed_area_1 * root,
            "fixed_2": p["fixed_discharge"] * g.fixed_area_2 * root,
            "variable": p["variable_discharge"] * root,
            "transient": length * p["variable_discharge"] * math.sqrt(2 * p["density"]),
            "port_radius": g.port_radius,
            "port_offset": g.port_offset,
            "stop_position": g.stop_position,
            "rim_thickness": p["rim_thickness"],
            "seal_leakage": g.seal_leakage if self.formulation.end_seals else 0.0,
        }

    def _pilot(self) -> dict[str, float]:
        groove, loss = self.groove, 0.0
        if self.formulation.groove_loss:
            loss = self.parameters["groove_loss_factor"] * self.parameters["density"] / (2 * groove.area**2)
        return {
            "groove_conductance": groove.conductance,
            "groove_length": groove.length,
            "groove_leakage": groove.leakage,
            "groove_angle": groove.angle,
            "entrance_loss": ENTRANCE_SHARE * loss,
            "exit_loss": (1 - ENTRANCE_SHARE) * loss,
        }

    def _options(self) -> dict[str, float]:
        f = self.formulation
        return {
            "pilot": f.pilot,
            "leakage_sign": leakage_sign(f),
            "pilot_bypass": f.pilot_bypass,
            "arc_holes": f.arc_holes,
            "chord_holes": f.chord_holes,
            "rim_holes": f.rim_holes,
            "orifice_law": f.orifice_law,
            "port_range": f.port_range,
            "stop": f.stop,
            "pressure_floor": f.pressure_floor,
        }

    def _inputs(self, span: Span, sized_for: float) -> dict[str, float]:
        p, inputs = self.parameters, span.inputs
        areas = load_areas(p, inputs.load_pressures, sized_for)
        first, second = (p["load_discharge"] * area * math.sqrt(2 / p["density"]) for area in areas)
        values = {
            "source_flow": inputs.source_flow,
            "spool_position": inputs.spool_position,
            "load_flow": sized_for / 2,
            "load_1": first,
            "load_2": second,
        }
        return values | _motion(span) if span.moving else values


def _motion(span: Span) -> dict[str, float]:
    """How the inputs move over a span."""
    duration, before, after = span.end - span.begin, span.inputs, span.final_inputs
    rates = [(b - a) / duration for a, b in zip(before.load_pressures, after.load_pressures, strict=True)]
    return {
        "moving": 1,
        "begin": span.begin,
        "source_flow_rate": (after.source_flow - before.source_flow) / duration,
        "spool_position_rate": (after.spool_position - before.spool_position) / duration,
        "load_pressure_1": before.load_pressures[0],
        "load_pressure_2": before.load_pressures[1],
        "load_pressure_1_rate": rates[0],
        "load_pressure_2_rate": rates[1],
    }
