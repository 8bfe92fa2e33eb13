"""The figures of `docs/model/`: each from its data to a drawing."""

import numpy as np

from divideropt.models.divider import FORMULATIONS, parameter_set
from divideropt.models.divider.formulations import Pilot
from divideropt.models.divider.ideal import flow_fraction, flow_ratio
from divideropt.models.divider.pilot import Groove
from modelpages.chart import Line, Note, Panel, draw
from modelpages.profile import groove_pressure
from modelpages.runs import Run, run
from modelpages.sweeps import clearance_sweep, rotation_sweep
from modelpages.tables import fixed

NEAR_LINEAR = (0.25, 0.75)
"""φ/φ0 between which the flow fraction is nearly straight."""

STROKES = {"conservative": (0, "solid"), "text": (1, "dash"), "listing": (2, "dashdot")}
"""Colour and dash of each formulation."""

NARROW_GROOVE, WIDE_GAPS = 0.3e-3, (20e-6, 40e-6)
"""Groove width and clearances [m] at which the profiles can be told apart."""


def figure_2_6() -> str:
    """Draw the ideal flow ratio and fraction against the spool's rotation."""
    places = np.linspace(0.02, 0.98, 193)
    ratios = ((0.5, "Ao1 : Ao2 = 1 : 2", 2, "dashdot"), (1.0, "1 : 1", 0, "solid"), (2.0, "2 : 1", 1, "dash"))
    fractions = [Line(label, places, flow_fraction(places, r), colour, dash) for r, label, colour, dash in ratios]
    quotients = [Line(label, places, flow_ratio(places, r), colour, dash) for r, label, colour, dash in ratios]
    return draw(
        [
            Panel(fractions, "φ/φ₀", "QL1/Qs, (2.7)", "flow fraction", (0.0, 1.0), (0.0, 1.0), shade=NEAR_LINEAR),
            Panel(quotients, "φ/φ₀", "QL1/QL2, (2.6)", "flow ratio", (0.0, 1.0), (0.0, 6.0), shade=NEAR_LINEAR),
        ],
        "Ideal flow fraction and ratio against the spool's rotary position, for three ratios of the fixed orifices",
    )


def figure_2_6_caption() -> str:
    """Say how straight the flow fraction is where it is shaded."""
    low, high = NEAR_LINEAR
    places = np.linspace(low, high, 2001)
    fractions = flow_fraction(places, 1.0)
    chord = np.interp(places, places[[0, -1]], fractions[[0, -1]])
    off = 100 * float(np.abs(fractions - chord).max())
    return (
        f"*Figure 2.6 drawn again. From {low} to {high} (shaded) the fraction for equal orifices stays within "
        f"{fixed(off, 1)} % of the source flow of a straight line.*"
    )


def unequal_division() -> str:
    """Draw the steady-state error against the spool's rotation."""
    sweeps = {name: rotation_sweep(name) for name in FORMULATIONS}
    after = [_line(n, s.places, s.of("steady_state_error")) for n, s in sweeps.items()]
    before = [_line(n, s.places, np.abs(s.of("ratio_bias"))) for n, s in sweeps.items()]
    label, extent = "error against the desired flows [%]", (0.0, 22.0)
    return draw(
        [
            Panel(before, "φ/φ₀", label, "both loads 10 MPa", (0.25, 0.75), extent),
            Panel(after, "φ/φ₀", label, "loads 15 and 10 MPa", (0.25, 0.75), extent),
        ],
        "Steady-state error (3.6) against the spool's rotary position in three formulations, equal and unequal loads",
    )


def clearance() -> str:
    """Draw the steady-state error and the fluid from nowhere against the clearance."""
    sweeps = {name: clearance_sweep(name) for name in FORMULATIONS}
    errors = [_line(n, s.places * 1e6, s.of("steady_state_error")) for n, s in sweeps.items()]
    flow = next(iter(sweeps.values())).runs[0].response.scenario.source_flow
    made = [
        _line(n, s.places * 1e6, 100 * s.fluid_from_nowhere / flow) for n, s in sweeps.items() if n != "conservative"
    ]
    return draw(
        [
            Panel(errors, "clearance δ [µm]", "steady-state error [%]", "division", (0.0, 20.0), (0.0, 8.0)),
            Panel(
                made,
                "clearance δ [µm]",
                "fluid from nowhere [% of Qs]",
                "mass balance",
                (0.0, 20.0),
                (1e-6, 10.0),
                log_y=True,
            ),
        ],
        "Steady-state error, and fluid that appears from nowhere, against the radial clearance in three formulations",
    )


def groove_profile() -> str:
    """Draw the pressure along a groove as each equation has it."""
    pressures = base_pressures()
    return draw(
        [_profile_panel(gap, pressures) for gap in WIDE_GAPS],
        "Pressure along a pilot groove by the hyperbolic and the two trigonometric solutions, for two clearances",
    )


def base_pressures() -> tuple[float, float, float]:
    """Return Ps, Pb1 and Pa1 [Pa] of the base set's equilibrium after the step."""
    rest = _step("conservative").response.phases[-1].rest
    if rest is None:
        raise ValueError("the base set has no equilibrium after the step, so there is no groove to draw")
    return float(rest.state[0]), float(rest.state[3]), float(rest.state[1])


def step_response() -> str:
    """Draw the load flows after the step."""
    flows, spools = [], []
    for name in FORMULATIONS:
        phase = _step(name).response.phases[-1]
        if phase.trajectory is None:
            raise ValueError(f"the step in {name!r} was not simulated")
        times = np.linspace(phase.trajectory.edges[0], 0.16, 321)
        states = phase.trajectory.at(times)
        both = phase.load_flows(states, times) * 1e3
        flows += [_line(name, times * 1e3, both[:, branch]) for branch in (0, 1)]
        spools.append(_line(name, times * 1e3, states[:, 6] * 1e3))
    names = (Note("QL1 rises", 14.0, 0.421), Note("QL2 falls", 10.0, 0.505))
    return draw(
        [
            Panel(flows, "time after the step [ms]", "load flow [L/s]", "load flows", (0.0, 160.0), notes=names),
            Panel(spools, "time after the step [ms]", "spool position [mm]", "spool", (0.0, 160.0)),
        ],
        "Load flows and spool position after the standard step, 10 to 15 MPa at load 1, in three formulations",
    )


FIGURES = {
    "figure_2_6": figure_2_6,
    "unequal_division": unequal_division,
    "clearance": clearance,
    "groove_profile": groove_profile,
    "step_response": step_response,
}
"""Each figure's file name without its ending, and what draws it."""


def _step(formulation: str) -> Run:
    return run(parameter_set("thesis_base"), FORMULATIONS[formulation])


def _line(formulation: str, x: np.ndarray, y: np.ndarray) -> Line:
    colour, dash = STROKES[formulation]
    return Line(formulation, x, y, colour, dash)


def _profile_panel(gap: float, pressures: tuple[float, float, float]) -> Panel:
    groove = Groove.of(parameter_set("thesis_base") | {"groove_width": NARROW_GROOVE, "radial_clearance": gap})
    angles = np.linspace(0.0, groove.angle, 241)
    kinds = (
        ("hyperbolic, (P4), (P5)", Pilot.HYPERBOLIC, "conservative"),
        ("(A.12), Chapter 2", Pilot.TRIGONOMETRIC, "text"),
        ("(A.14), without the particular solution", Pilot.HOMOGENEOUS, "listing"),
    )
    lines = []
    for label, pilot, like in kinds:
        profile = groove_pressure(pilot, angles, groove.angle / 2, groove.angle, groove.length, pressures) / 1e6
        lines.append(Line(label, angles / groove.angle, profile, *STROKES[like]))
    return Panel(lines, "s/φ₀", "groove pressure [MPa]", f"δ = {gap * 1e6:.0f} µm", (0.0, 1.0), (17.0, 20.0))
