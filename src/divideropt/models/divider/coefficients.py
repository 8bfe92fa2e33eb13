"""From parameters and inputs to the record that the equations of motion read."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from divideropt.models.divider.formulations import Formulation
from divideropt.models.divider.geometry import Geometry, derive_geometry
from divideropt.models.divider.kernels import fold_pilot
from divideropt.models.divider.pilot import ENTRANCE_SHARE, Groove, leakage_sign
from divideropt.models.divider.record import Design, blank_coefficients
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
        design = blank_coefficients()
        self._fill_valve(design)
        self._fill_pilot(design)
        self._fill_options(design)
        self._fill_inputs(design, span, sized_for)
        d = design[0]
        fold_pilot(d.spool_position, d)
        return design

    def _fill_valve(self, design: Design) -> None:
        d, p, g = design[0], self.parameters, self.geometry
        root = math.sqrt(2 / p["density"])
        d.source_gain = p["bulk_modulus"] / p["source_volume"]
        d.chamber_gain = p["bulk_modulus"] / g.chamber_volume
        d.load_gain = p["bulk_modulus"] / p["load_volume"]
        d.bulk_modulus = p["bulk_modulus"]
        d.end_volume = g.end_volume
        d.end_area = g.end_area
        d.mass = g.mass
        d.viscous_friction = g.viscous_friction
        d.coulomb_friction = p["coulomb_friction"]
        d.fixed_1 = p["fixed_discharge"] * g.fixed_area_1 * root
        d.fixed_2 = p["fixed_discharge"] * g.fixed_area_2 * root
        d.variable = p["variable_discharge"] * root
        length = p["damping_length"] if self.formulation.transient_force else 0.0
        d.transient = length * p["variable_discharge"] * math.sqrt(2 * p["density"])
        d.port_radius = g.port_radius
        d.port_offset = g.port_offset
        d.stop_position = g.stop_position
        d.rim_thickness = p["rim_thickness"]
        d.seal_leakage = g.seal_leakage if self.formulation.end_seals else 0.0

    def _fill_pilot(self, design: Design) -> None:
        d, groove = design[0], self.groove
        d.groove_conductance = groove.conductance
        d.groove_length = groove.length
        d.groove_leakage = groove.leakage
        d.groove_angle = groove.angle
        if self.formulation.groove_loss:
            loss = self.parameters["groove_loss_factor"] * self.parameters["density"] / (2 * groove.area**2)
            d.entrance_loss, d.exit_loss = ENTRANCE_SHARE * loss, (1 - ENTRANCE_SHARE) * loss

    def _fill_options(self, design: Design) -> None:
        d, f = design[0], self.formulation
        d.pilot = f.pilot
        d.leakage_sign = leakage_sign(f)
        d.pilot_bypass = f.pilot_bypass
        d.arc_holes, d.chord_holes, d.rim_holes = f.arc_holes, f.chord_holes, f.rim_holes
        d.orifice_law = f.orifice_law
        d.port_range = f.port_range
        d.stop = f.stop
        d.pressure_floor = f.pressure_floor

    def _fill_inputs(self, design: Design, span: Span, sized_for: float) -> None:
        d, p, inputs = design[0], self.parameters, span.inputs
        d.source_flow = inputs.source_flow
        d.spool_position = inputs.spool_position
        d.load_flow = sized_for / 2
        areas = load_areas(p, inputs.load_pressures, sized_for)
        d.load_1, d.load_2 = (p["load_discharge"] * area * math.sqrt(2 / p["density"]) for area in areas)
        if not span.moving:
            return
        duration, final = span.end - span.begin, span.final_inputs
        d.moving, d.begin = 1, span.begin
        d.source_flow_rate = (final.source_flow - inputs.source_flow) / duration
        d.spool_position_rate = (final.spool_position - inputs.spool_position) / duration
        d.load_pressure_1, d.load_pressure_2 = inputs.load_pressures
        d.load_pressure_1_rate, d.load_pressure_2_rate = (
            (after - before) / duration
            for before, after in zip(inputs.load_pressures, final.load_pressures, strict=True)
        )
