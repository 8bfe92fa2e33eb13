"""Metrics that section 3.1 and the code define otherwise than each other, measured on one response."""

import math
from collections.abc import Callable

import numpy as np

from divideropt.models.base import Outcome
from divideropt.models.divider import FORMULATIONS, QUANTITIES, Scenario, parameter_set
from divideropt.models.divider.metric_kernels import SETTLING_BAND
from modelpages.limits import sample, simulate
from modelpages.options import PARAMETERS
from modelpages.runs import Run, run
from modelpages.tables import fixed, table

GRID = 400_001
"""Instants at which a response is sampled for what the model does not measure itself: every 2.5 µs."""


def measures_table() -> str:
    """Tabulate each metric both ways, `conservative`, settled start."""
    base, prototype = (run(PARAMETERS[name], FORMULATIONS["conservative"]) for name in ("base", "prototype"))
    rows = [
        [
            "dynamic error (3.10) with the flows through the load orifices [mL]",
            *_both(dynamic_error, base, prototype),
        ],
        ["the same with the flows through the ports, (2.13) [mL]", *_both(dynamic_error_at_ports, base, prototype)],
        ["$E_{CU}$ (3.8) over 0.2 s [mL]", *_both(lambda r: r["cumulative_error"] * 1e6, base, prototype)],
        ["$E_{CUSS}$ (3.9) + $E_{CUDY}$ (3.10) [mL]", *_both(sum_of_parts, base, prototype)],
        ["pressure loss over the branch with the greater load, section 3.1 [MPa]", *_both(loss, base, prototype)],
        ["the same as coded, over the greater of $P_{L2}$ and 15 MPa [MPa]", *_both(loss_as_coded, base, prototype)],
        [
            "settling time by branch 1 alone, as coded [ms]",
            *_both(lambda r: r["settling_time"] * 1e3, base, prototype),
        ],
        ["settling time of branch 2 [ms]", *_both(settling_of_branch_2, base, prototype)],
    ]
    return table(["", "`thesis_base`", "`thesis_prototype`"], rows, numbers_from=1)


def rotated_table() -> str:
    """Tabulate (3.6) and what C.2 and C.5 compute in its place, with the spool turned; `conservative`, base set."""
    rows = []
    for position in (0.4, 0.5, 0.6):
        found = run(parameter_set("thesis_base"), FORMULATIONS["conservative"], Scenario(spool_position=position))
        rows.append([f"{position}", fixed(found["steady_state_error"], 3), fixed(abs(found["flow_difference"]), 3)])
    return table(["φ/φ₀", "(3.6) [%]", "magnitude of (3.5), as coded [%]"], rows, numbers_from=1)


def cancelling_table(count: int) -> str:
    """Tabulate how often over- and undershoot cancel in (3.10), over designs of the box of C.6.

    Args:
        count: How many designs, a power of 2.
    """
    names, rows = list(QUANTITIES), []
    for formulation in FORMULATIONS:
        values, outcomes = simulate(sample(count), FORMULATIONS[formulation])
        good = values[[o is Outcome.OK for o in outcomes]]
        signed, magnitude = (good[:, names.index(name)] for name in ("dynamic_error", "dynamic_error_abs"))
        lost = 1 - np.abs(signed) / magnitude
        pressure = good[lost > 0.01, names.index("source_pressure")]
        lowest = float(pressure.min()) / 1e6 if pressure.size else math.nan
        rows.append(
            [
                f"`{formulation}`",
                f"{len(good)}",
                f"{pressure.size}",
                fixed(100 * float(lost.max()), 0),
                fixed(lowest, 1),
            ]
        )
    header = [
        "",
        f"`ok`, of {count}",
        "of these, over 1 % cancelled",
        "most cancelled [%]",
        "lowest source pressure among those [MPa]",
    ]
    return table(header, rows, numbers_from=1)


def dynamic_error(found: Run) -> float:
    """(3.10) as measured [mL]."""
    return found["dynamic_error"] * 1e6


def dynamic_error_at_ports(found: Run) -> float:
    """(3.10) with the flows through the ports [mL]: more by what each load line takes up until they have settled."""
    phase = found.response.phases[-1]
    if phase.trajectory is None:
        return math.nan
    begin = float(phase.trajectory.edges[0])
    early, late = phase.trajectory.at(np.array([begin, begin + found["settling_time"]]))[:, 7:9]
    taken_up = (late - early) * found.response.parameters["load_volume"] / found.response.parameters["bulk_modulus"]
    return (found["dynamic_error"] + float(taken_up[0] - taken_up[1])) * 1e6


def sum_of_parts(found: Run) -> float:
    """(3.9) + (3.10) [mL]."""
    scenario = found.response.scenario
    steady = found["cumulative_steady_error_percent"] / 100 * scenario.source_flow * scenario.accumulation_time
    return (steady + found["dynamic_error"]) * 1e6


def loss(found: Run) -> float:
    """Ps less the greater load pressure reached [MPa]."""
    return found["pressure_loss"] / 1e6


def loss_as_coded(found: Run) -> float:
    """`DeltaP` of C.2 and C.5 [MPa]: Ps less the greater of PL2 and the pressure for which load 1 was sized."""
    last = found.response.phases[-1]
    if last.rest is None:
        return math.nan
    stated = found.response.scenario.spans()[-1].inputs.load_pressures[0]
    return (found["source_pressure"] - max(float(last.rest.state[8]), stated)) / 1e6


def settling_of_branch_2(found: Run) -> float:
    """Settling time as defined, but of the other branch [ms], on a grid of instants."""
    phase = found.response.phases[-1]
    if phase.trajectory is None or phase.rest is None:
        return math.nan
    times = np.linspace(phase.trajectory.edges[0], phase.trajectory.edges[-1], GRID)
    flows = phase.load_flows(phase.trajectory.at(times), times)[:, 1]
    final = float(phase.load_flows(phase.rest.state)[1])
    outside = np.flatnonzero(np.abs(flows - final) > SETTLING_BAND * final)
    return 1e3 * float(times[outside[-1]] - times[0]) if outside.size else 0.0


def _both(what: Callable[[Run], float], *runs: Run) -> list[str]:
    return [fixed(what(found), 3) for found in runs]
