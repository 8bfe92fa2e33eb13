"""The figures of Chapters 2 to 4 in their order: those that a program draws, and why it cannot draw the others."""

from collections.abc import Mapping
from types import MappingProxyType

from claims.judgement import Statement
from modelpages.figures import figure_2_6

from thesisfigures import complex_run, flows, ideal, standard_test, sweeps, twins
from thesisfigures.figure import Both, Figure
from thesisfigures.statements import said_in_3_4, said_in_4


def _flows(number: str, parameter: str, words: str, own: tuple[Statement, ...] = ()) -> Figure:
    shows = f"Load flow response to a step in load orifice area, showing the effect of changing {words}"
    return Figure(
        number, shows, flows.draw_flows(parameter), said_in_3_4(number, own), flows.outcomes_of_five(parameter)
    )


def _errors(number: str, parameter: str, shows: str) -> Figure:
    return Figure(number, shows, sweeps.draw_errors(parameter), said_in_3_4(number), sweeps.left_out(parameter))


def _settling(number: str, parameter: str, words: str, own: tuple[Statement, ...] = ()) -> Figure:
    shows = f"Effect of {words} on the settling time"
    return Figure(
        number, shows, sweeps.draw_settling(parameter), said_in_3_4(number, own), sweeps.left_out(parameter)
    )


def _ideal(_: Both) -> str:
    return figure_2_6()


FIGURES: tuple[Figure, ...] = (
    Figure(
        "2.6",
        "The non-dimensional ideal flow for identical fixed orifices, as well as 2:1 and 1:2 fixed orifice ratios",
        _ideal,
        ideal.judge_ideal,
    ),
    Figure(
        "3.1",
        "A sample step response of the simulated valve",
        standard_test.draw_step_response,
        said_in_3_4("3.1", standard_test.STEP_RESPONSE),
        standard_test.another_test,
    ),
    Figure(
        "3.2",
        "A sample flow result showing the cumulative steady state error and the cumulative dynamic error",
        standard_test.draw_errors_shaded,
        said_in_3_4("3.2", standard_test.ERRORS_SHADED),
        standard_test.volumes,
    ),
    _flows("3.3", "spool_radius", "spool radius, r", (flows.told_apart("spool_radius"),)),
    _errors("3.4", "spool_radius", "Effect of radius on the steady state and accumulated error after 0.2 s"),
    _settling("3.5", "spool_radius", "radius", (sweeps.settling_is_strong("spool_radius"),)),
    Figure(
        "3.6",
        "The valve appears to show instability with a radius of 3 mm",
        flows.draw_lost_control,
        said_in_3_4("3.6"),
    ),
    _flows("3.7", "groove_width", "the circumferential groove thickness, b"),
    _errors("3.8", "groove_width", "Effect of groove thickness on the accumulated error after 0.2 s"),
    _settling("3.9", "groove_width", "groove thickness"),
    _flows("3.10", "radial_clearance", "the spool’s radial clearance, δ"),
    _errors("3.11", "radial_clearance", "Effect of clearance on the accumulated error after 0.2 s"),
    _flows("3.12", "total_pressure_drop", "the pressure drop, ΔPt"),
    _errors("3.13", "total_pressure_drop", "Effect of the total pressure drop on the accumulated error after 0.2 s"),
    _settling("3.14", "total_pressure_drop", "pressure drop"),
    _flows(
        "3.15",
        "fixed_drop_ratio",
        "the ratio of the pressure drop across the fixed orifice to the total drop",
        (flows.told_apart("fixed_drop_ratio"),),
    ),
    _errors("3.16", "fixed_drop_ratio", "Effect of the pressure drop ratio on the accumulated error after 0.2 s"),
    _settling("3.17", "fixed_drop_ratio", "pressure drop ratio", (sweeps.settling_is_strong("fixed_drop_ratio"),)),
    _flows("3.18", "centred_opening", "the fraction that the variable orifices are open when the valve is centred"),
    _errors("3.19", "centred_opening", "Effect of the opening fraction on the accumulated error after 0.2 s"),
    Figure(
        "3.20",
        "Effect of opening fraction on the steady state source pressure",
        sweeps.draw_source_pressure("centred_opening"),
        said_in_3_4("3.20"),
        sweeps.left_out("centred_opening"),
    ),
    _settling("3.21", "centred_opening", "opening fraction"),
    _flows("3.22", "rim_thickness", "the rim thickness, t_rim"),
    _errors("3.23", "rim_thickness", "Effect of the rim thickness on the accumulated error after 0.2 s"),
    _flows("3.24", "coulomb_friction", "the Coulomb friction, Fc"),
    _errors("3.25", "coulomb_friction", "Effect of Coulomb friction on the accumulated error after 0.2 s"),
    _flows("3.26", "kinematic_viscosity", "the viscosity, ν"),
    _errors("3.27", "kinematic_viscosity", "Effect of the viscosity on the accumulated error after 0.2 s"),
    _settling("3.28", "kinematic_viscosity", "viscosity"),
    Figure(
        "3.29",
        "The complex method used to solve a two-dimensional optimization problem",
        complex_run.draw_complex,
        complex_run.judge_complex,
        complex_run.what_was_run,
    ),
    Figure(
        "4.4",
        "Load flow response to a step in load pressure difference (measured; ours is a simulated twin)",
        twins.draw_first_test,
        said_in_4("4.4", twins.FIRST_TEST_FLOWS, also=("section 4.3",)),
        twins.what_was_assumed,
    ),
    Figure(
        "4.5",
        "Valve pressures during the above test (measured; ours is a simulated twin)",
        twins.draw_pressures,
        said_in_4("4.5", twins.FIRST_TEST_PRESSURES),
    ),
    Figure(
        "4.8",
        "Flow responses, showing the effect of rotating the spool (measured; ours is a simulated twin)",
        twins.draw_rotated,
        said_in_4("4.8"),
        twins.how_far_turned,
    ),
)
"""What a program draws."""

NOT_DRAWN: Mapping[str, str] = MappingProxyType(
    {
        "2.1": "circuit diagrams of a fixed-ratio divider and of this one: symbols, nothing is computed",
        "2.2": "cutaway view of the valve, from the author’s drawings: a shape, and the model has none but radii and "
        "lengths",
        "2.3": "exploded view, likewise",
        "2.4": "schematic with the names of pressures and flows: a legend to the equations",
        "2.5": "sketch of the grooves in three positions of the spool; what it says of the pressures is (2.3), (2.4)",
        "2.7": "sketch of leakage paths: the model has the straight ones on its left alone; no program of ours "
        "computes the flow lines on its right",
        "2.8": "sketch of a port’s edge with a rim and without; the jet itself is not modelled",
        "2.9": "sketch with the names of the pilot flows",
        "4.1": "photographs of the prototype",
        "4.2": "circuit diagram of the rig",
        "4.3": "photograph of the rig",
        "4.6": "three repeats of one measurement: the model gives the same response three times",
        "4.7": "their standard deviation: in the model 0",
    }
)
"""Why each of the others cannot be drawn. Chapter 3 has none."""
