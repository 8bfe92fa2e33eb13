"""Options that matter only where the valve leaves its range: how many designs of the author's box they touch."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.stats import qmc

from divideropt.campaign.load import default_campaign
from divideropt.models.base import FloatArray, Outcome
from divideropt.models.divider import FORMULATIONS, Scenario, parameter_set, solver_settings
from divideropt.models.divider.formulations import Formulation, OrificeLaw, PortRange, PressureFloor, Stop
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.response import respond
from modelpages.tables import fixed, power, table

BOX = default_campaign().variables
"""Bounds of the complex run, C.6."""

CODED_PORTS, PRINTED_PORTS = "ports held in port 1's range (C.3)", "ports as printed (2.15)"

CHANGES: Mapping[str, Mapping[str, Any]] = {
    "`conservative`": {},
    "signed root (C.3)": {"orifice_law": OrificeLaw.SIGNED_ROOT},
    "tanh (2.9)": {"orifice_law": OrificeLaw.TANH_ROOT},
    CODED_PORTS: {"port_range": PortRange.FIRST},
    PRINTED_PORTS: {"port_range": PortRange.PRINTED},
    "frozen at the stop (C.3)": {"stop": Stop.FROZEN},
    "no stop (Chapter 2)": {"stop": Stop.NONE},
    "pressures clamped in the forces (C.3)": {"pressure_floor": PressureFloor.EVERYTHING},
    "negative pressures as they are (Chapter 2)": {"pressure_floor": PressureFloor.NOTHING},
}
"""What is changed in `conservative`, by the row's label."""

Results = tuple[FloatArray, list[Outcome]]


def limits_table(count: int) -> str:
    """Tabulate outcomes over the first designs of an unscrambled Sobol sequence in the box, and say what ports do.

    Args:
        count: How many designs, a power of 2.
    """
    designs = sample(count)
    found = {
        label: simulate(designs, replace(FORMULATIONS["conservative"], **changes))
        for label, changes in CHANGES.items()
    }
    reference = found["`conservative`"]
    outcomes = sorted({o for _, all_of_them in found.values() for o in all_of_them}, key=list(Outcome).index)
    header = ["", *(f"`{o}`" for o in outcomes), "outcome differs", "largest change of an error [%]"]
    rows = [_row(label, got, reference, outcomes) for label, got in found.items()]
    return f"{table(header, rows, numbers_from=1)}\n\n{_beyond_the_range(found)}"


def sample(count: int) -> list[dict[str, float]]:
    """Return designs of the box, the other parameters as in B.1."""
    low, high = zip(*BOX.values(), strict=True)
    points = qmc.scale(qmc.Sobol(len(BOX), scramble=False).random(count), low, high)
    return [parameter_set("thesis_base") | dict(zip(BOX, point, strict=True)) for point in points.tolist()]


def simulate(designs: Sequence[Mapping[str, float]], formulation: Formulation) -> Results:
    """Return each design's quantities, shape (n, m), and outcome in the standard test, at the default tolerance."""
    measured = [measure(respond(p, formulation, Scenario(), solver_settings())) for p in designs]
    return np.array([row for row, _ in measured]), [verdict.outcome for _, verdict in measured]


def _beyond_the_range(found: Mapping[str, Results]) -> str:
    """Say what becomes of the designs whose ports, as printed, are not numbers on the way."""
    own, printed, coded = (found[label][1] for label in ("`conservative`", PRINTED_PORTS, CODED_PORTS))
    leaving = [i for i, outcome in enumerate(printed) if outcome is Outcome.NOT_COMPLETED]
    working = [i for i in leaving if own[i] is Outcome.OK]
    as_coded = Counter(coded[i] for i in working)
    return (
        f"With the printed areas {len(leaving)} of the {len(printed)} designs cannot be simulated: their spool "
        f"leaves a port's range. Of these {len(working)} are `ok` once each port has its own range;\nwith the code's "
        f"ranges they are {', '.join(f'`{outcome}` ({count})' for outcome, count in as_coded.most_common())}."
    )


def _row(label: str, got: Results, reference: Results, outcomes: Sequence[Outcome]) -> list[str]:
    counts = Counter(got[1])
    same = [i for i, (a, b) in enumerate(zip(got[1], reference[1], strict=True)) if a == b == Outcome.OK]
    change = float(np.abs(got[0][same, 0] - reference[0][same, 0]).max())
    differ = sum(a != b for a, b in zip(got[1], reference[1], strict=True))
    return [label, *(str(counts[o]) for o in outcomes), fixed(differ, 0), power(change, 0, 1e-9)]
