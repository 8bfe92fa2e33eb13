"""From a design and a scenario's inputs to the record that the equations of motion read, compiled.

Geometry is (3.13)–(3.22), as coded in C.1; the grooves' numbers are those of Appendix A.
"""

import math

from divideropt.models.divider.groove_kernels import fold_pilot
from divideropt.ode.compiled import compiled

STEEL_DENSITY = 7870.0
"""Density of the spool [kg/m^3], from C.1."""

STROKE_MARGIN = 1.3
"""Stop position over the position at which port 1 is just fully open, from C.1."""

GROOVE_FACTOR = 185.0
"""Laminar flow through an equilateral triangle of side b: Q = -b⁴/(185 μ) dP/dl, (A.3)."""

ENTRANCE_SHARE = 1.0 / 3.0
"""Share of a groove's loss at the supply's end: 0.5 of the 1.5 velocity heads of a sharp entrance and an exit."""


@compiled
def derive(row, holes, stem, geometry):  # type: ignore[no-untyped-def]
    """Derive the geometry.

    Args:
        row: `PARAMETER_ROW`, shape (1,).
        holes: Holes a port has; enters `open_drop` alone.
        stem: Whether the spool end's area is less that of the stem.
        geometry: `GEOMETRY`, shape (1,); receives it.
    """
    _derive(row[0], holes, stem, geometry[0])


@compiled
def prepare(row, options, geometry, design):  # type: ignore[no-untyped-def]
    """Fill geometry and record of a design, but for its inputs.

    Args:
        row: `PARAMETER_ROW`, shape (1,).
        options: `OPTIONS`, shape (1,).
        geometry: `GEOMETRY`, shape (1,); receives it.
        design: `COEFFICIENTS`, shape (1,); receives it.
    """
    p, g, f, d = row[0], geometry[0], options[0], design[0]
    _derive(p, f.arc_holes, f.stem, g)
    _fill_valve(p, g, f, d)
    _fill_options(p, g, f, d)


@compiled
def apply_span(row, spans, number, sized_for, design):  # type: ignore[no-untyped-def]
    """Fill a record's inputs over a stretch of time, and fold its pilot stage.

    Args:
        row: `PARAMETER_ROW`, shape (1,).
        spans: `SPAN`, shape (p,).
        number: Which of them.
        sized_for: Source flow for which the load orifices are sized, section 3.1 [m^3/s].
        design: `COEFFICIENTS`, shape (1,); receives it.
    """
    p, span, d = row[0], spans[number], design[0]
    root = math.sqrt(2.0 / p.density)
    # AL = (Qs/2) / (CdL √(2/ρ pL)), so that half the source flow makes the stated pressure.
    area_1 = (sized_for / 2.0) / (p.load_discharge * math.sqrt(2.0 / p.density * span.load_pressure_1))
    area_2 = (sized_for / 2.0) / (p.load_discharge * math.sqrt(2.0 / p.density * span.load_pressure_2))
    d.source_flow, d.spool_position = span.source_flow, span.spool_position
    d.load_flow = sized_for / 2.0
    d.load_1, d.load_2 = p.load_discharge * area_1 * root, p.load_discharge * area_2 * root
    d.moving = span.moving
    if span.moving != 0:
        duration = span.end - span.begin
        d.begin = span.begin
        d.source_flow_rate = (span.final_source_flow - span.source_flow) / duration
        d.spool_position_rate = (span.final_spool_position - span.spool_position) / duration
        d.load_pressure_1, d.load_pressure_2 = span.load_pressure_1, span.load_pressure_2
        d.load_pressure_1_rate = (span.final_load_pressure_1 - span.load_pressure_1) / duration
        d.load_pressure_2_rate = (span.final_load_pressure_2 - span.load_pressure_2) / duration
    fold_pilot(d.spool_position, d)


@compiled
def _derive(p, holes, stem, g):  # type: ignore[no-untyped-def]
    r = p.spool_radius
    viscosity = p.kinematic_viscosity * p.density
    land_length = p.land_length_ratio * p.land_distance
    g.viscosity = viscosity
    g.spool_length = land_length / p.land_fraction
    g.stem_radius = r * p.stem_ratio
    g.end_area = math.pi * (r * r - (g.stem_radius * g.stem_radius if stem != 0 else 0.0))  # (3.13)
    g.mass = p.mass_ratio * r * r * math.pi * g.spool_length * STEEL_DENSITY  # (3.14)
    g.viscous_friction = 2.0 * math.pi * r * land_length * viscosity / p.radial_clearance  # (3.16)

    drop, fixed_drop = p.total_pressure_drop, p.fixed_drop_ratio * p.total_pressure_drop
    fixed_area = _orifice_area(p.design_flow, p.fixed_discharge, p.density, fixed_drop)  # (3.17)
    share_1 = 2.0 * p.fixed_area_ratio / (1.0 + p.fixed_area_ratio)
    g.fixed_area_1, g.fixed_area_2 = fixed_area * share_1, fixed_area * (2.0 - share_1)
    port_area = _orifice_area(p.design_flow, p.variable_discharge, p.density, drop - fixed_drop)
    g.port_radius = math.sqrt(port_area / math.pi)  # (3.18): for one hole, as the prototype was drawn
    g.port_offset = g.port_radius * (1.0 - 2.0 * p.centred_opening)  # (3.19)
    g.open_drop = fixed_drop + (drop - fixed_drop) / (holes * holes)

    g.stop_position = STROKE_MARGIN * (g.port_offset + g.port_radius)
    g.end_volume = (p.end_clearance + g.stop_position) * g.end_area  # (3.20), (3.21)
    g.chamber_volume = math.pi * (r * r - (r / 2.0) * (r / 2.0)) * p.chamber_length  # (3.22)
    gap = p.radial_clearance * p.radial_clearance * p.radial_clearance
    g.seal_leakage = g.stem_radius * math.pi * gap / (6.0 * viscosity * p.seal_length)

    b = p.groove_width
    b4 = b * b * b * b
    length = math.sqrt(6.0 * b4 * p.land_distance / (GROOVE_FACTOR * r * r * gap))
    g.groove_length = length
    g.groove_conductance = b4 / (GROOVE_FACTOR * viscosity * r * length)
    g.groove_leakage = r * gap / (6.0 * viscosity * p.land_distance)
    g.groove_angle = p.groove_angle
    g.groove_area = math.sqrt(3.0) / 4.0 * b * b
    g.groove_diameter = b / math.sqrt(3.0)


@compiled
def _orifice_area(flow, discharge, density, drop):  # type: ignore[no-untyped-def]
    """Area [m^2] that passes a flow [m^3/s] at a drop [Pa], (3.17)."""
    return flow / (discharge * math.sqrt(2.0 / density * drop))


@compiled
def _fill_valve(p, g, f, d):  # type: ignore[no-untyped-def]
    """Everything of the valve itself."""
    root = math.sqrt(2.0 / p.density)
    d.source_gain = p.bulk_modulus / p.source_volume
    d.chamber_gain = p.bulk_modulus / g.chamber_volume
    d.load_gain = p.bulk_modulus / p.load_volume
    d.bulk_modulus = p.bulk_modulus
    d.end_volume, d.end_area = g.end_volume, g.end_area
    d.mass = g.mass
    d.viscous_friction, d.coulomb_friction = g.viscous_friction, p.coulomb_friction
    d.fixed_1, d.fixed_2 = p.fixed_discharge * g.fixed_area_1 * root, p.fixed_discharge * g.fixed_area_2 * root
    d.variable = p.variable_discharge * root
    length = p.damping_length if f.transient_force != 0 else 0.0
    d.transient = length * p.variable_discharge * math.sqrt(2.0 * p.density)
    d.port_radius, d.port_offset, d.stop_position = g.port_radius, g.port_offset, g.stop_position
    d.rim_thickness = p.rim_thickness
    d.seal_leakage = g.seal_leakage if f.end_seals != 0 else 0.0
    d.extra_force = 0.0


@compiled
def _fill_options(p, g, f, d):  # type: ignore[no-untyped-def]
    """The pilot stage, unfolded, and what the formulation chooses."""
    d.groove_conductance, d.groove_length = g.groove_conductance, g.groove_length
    d.groove_leakage, d.groove_angle = g.groove_leakage, g.groove_angle
    loss = 0.0
    if f.groove_loss != 0:
        loss = p.groove_loss_factor * p.density / (2.0 * g.groove_area * g.groove_area)
    d.entrance_loss, d.exit_loss = ENTRANCE_SHARE * loss, (1.0 - ENTRANCE_SHARE) * loss
    d.pilot, d.leakage_sign, d.pilot_bypass = f.pilot, f.leakage_sign, f.pilot_bypass
    d.arc_holes, d.chord_holes, d.rim_holes = f.arc_holes, f.chord_holes, f.rim_holes
    d.orifice_law, d.port_range, d.stop, d.pressure_floor = f.orifice_law, f.port_range, f.stop, f.pressure_floor
