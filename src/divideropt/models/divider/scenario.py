"""What happens to the valve: the inputs before and after each event, and the record the kernel reads."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from divideropt.models.divider.formulations import Formulation
from divideropt.models.divider.geometry import Geometry
from divideropt.models.divider.kernels import blank_coefficients
from divideropt.models.divider.pilot import PilotSide


@dataclass(frozen=True)
class Inputs:
    """What is constant between two events.

    Attributes:
        source_flow: Qs [m^3/s].
        spool_position: φ/φ0.
        load_pressures: The steady load pressures [Pa] for which the load orifices are sized.
    """

    source_flow: float
    spool_position: float
    load_pressures: tuple[float, float]


@dataclass(frozen=True)
class Scenario:
    """One load step, from rest at an equilibrium or from an empty valve.

    Attributes:
        source_flow: Qs [m^3/s].
        spool_position: φ/φ0, strictly between 0 and 1.
        load_pressures: Steady load pressures before the step [Pa].
        step_load: Which load steps, 1 or 2.
        step_pressure: Its steady pressure after the step [Pa].
        settled: Whether to start at the equilibrium before the step; else from all states zero.
        step_time: When the load steps [s]; 0 for a settled start.
        end_time: When the simulation ends [s].
        accumulation_time: t_cum of (3.8), (3.11), (3.12) [s].
    """

    source_flow: float = 1e-3
    spool_position: float = 0.5
    load_pressures: tuple[float, float] = (10e6, 10e6)
    step_load: int = 1
    step_pressure: float = 15e6
    settled: bool = True
    step_time: float = 0.0
    end_time: float = 1.0
    accumulation_time: float = 0.2

    def phases(self) -> tuple[tuple[Inputs, float, float], ...]:
        """Inputs between the events, each with its first and last time [s]; a settled start takes no time."""
        first, second = self.load_pressures
        stepped = (self.step_pressure, second) if self.step_load == 1 else (first, self.step_pressure)
        return (
            (Inputs(self.source_flow, self.spool_position, self.load_pressures), 0.0, self.step_time),
            (Inputs(self.source_flow, self.spool_position, stepped), self.step_time, self.end_time),
        )


def load_areas(p: Mapping[str, float], inputs: Inputs) -> tuple[float, float]:
    """Size the load orifices so that half the source flow makes the stated pressures, section 3.1.

    Args:
        p: Every parameter by name, SI.
        inputs: The inputs in force.

    Returns:
        AL1 and AL2 [m^2].
    """
    first, second = (
        (inputs.source_flow / 2) / (p["load_discharge"] * math.sqrt(2 / p["density"] * pressure))
        for pressure in inputs.load_pressures
    )
    return first, second


def coefficients(
    p: Mapping[str, float],
    geometry: Geometry,
    sides: tuple[PilotSide, PilotSide],
    inputs: Inputs,
    formulation: Formulation,
) -> NDArray[np.record]:
    """Fill what the kernel reads for one design under one set of inputs.

    Args:
        p: Every parameter by name, SI.
        geometry: What `p` makes.
        sides: The folded pilot stage at `inputs.spool_position`.
        inputs: The inputs in force.
        formulation: Which reading of the valve.

    Returns:
        `COEFFICIENTS`, shape (1,).
    """
    root = math.sqrt(2 / p["density"])
    area_1, area_2 = load_areas(p, inputs)
    design = blank_coefficients()
    d = design[0]
    d.source_gain = p["bulk_modulus"] / p["source_volume"]
    d.chamber_gain = p["bulk_modulus"] / geometry.chamber_volume
    d.load_gain = p["bulk_modulus"] / p["load_volume"]
    d.bulk_modulus = p["bulk_modulus"]
    d.end_volume = geometry.end_volume
    d.end_area = geometry.end_area
    d.mass = geometry.mass
    d.viscous_friction = geometry.viscous_friction
    d.coulomb_friction = p["coulomb_friction"]
    d.fixed_1 = p["fixed_discharge"] * geometry.fixed_area_1 * root
    d.fixed_2 = p["fixed_discharge"] * geometry.fixed_area_2 * root
    d.variable = p["variable_discharge"] * root
    d.load_1 = p["load_discharge"] * area_1 * root
    d.load_2 = p["load_discharge"] * area_2 * root
    length = p["damping_length"] if formulation.transient_force else 0.0
    d.transient = length * p["variable_discharge"] * math.sqrt(2 * p["density"])
    d.port_radius = geometry.port_radius
    d.port_offset = geometry.port_offset
    d.stop_position = geometry.stop_position
    d.rim_thickness = p["rim_thickness"]
    d.seal_leakage = geometry.seal_leakage if formulation.end_seals else 0.0
    d.source_flow = inputs.source_flow
    d.pilot_1 = sides[0].net()
    d.pilot_2 = sides[1].net()
    d.arc_holes = formulation.arc_holes
    d.chord_holes = formulation.chord_holes
    d.rim_holes = formulation.rim_holes
    d.orifice_law = formulation.orifice_law
    d.port_range = formulation.port_range
    d.stop = formulation.stop
    d.pressure_floor = formulation.pressure_floor
    return design
