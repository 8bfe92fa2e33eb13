"""The tests of Chapter 4 in the model, with what it does not say assumed openly, one assumption changed at a time.

Drops and load differences are set as by procedure E.3: with the pilot line shut, so that half of Qs passes each fixed
orifice. Opened, the line takes flow past the orifices, so that what comes out differs from what is stated.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from claims.runs import SETTINGS
from divideropt.models.base import Outcome
from divideropt.models.divider import FORMULATIONS, QUANTITIES, Scenario, load_step, parameter_set, rig
from divideropt.models.divider.metrics import measure as quantities_of
from divideropt.models.divider.response import Response, respond
from divideropt.problem.simulation import one_thread

SECONDS = 3.0
"""How long a response runs after the step [s]: many times what any of them needs."""

CENTRED = 0.5
"""φ/φ0 of Tables 4.1 and 4.2."""


@dataclass(frozen=True)
class Assumptions:
    """What Chapter 4 and Appendix E do not say.

    Attributes:
        name: What is different from the first.
        back_pressure: Of a branch whose counterbalance valve is bypassed [Pa].
        load_pressure: Of both before the step [Pa]; None where it is the load difference above the back pressure.
        volumes: Flow chambers and load lines over those of Appendix B.2.
        source_volume: Between pump and orifices [m^3].
        friction: Coulomb friction of the spool [N].
        viscosity: Of the oil [m^2/s].
        raised: Whether the load of branch 1 rises by the difference, as in Chapter 3, instead of falling.
    """

    name: str
    back_pressure: float = 1e6
    load_pressure: float | None = None
    volumes: float = 10.0
    source_volume: float = 1e-3
    friction: float = 0.0
    viscosity: float = 30e-6
    raised: bool = False


ASSUMED = Assumptions("as assumed")

CASES: tuple[Assumptions, ...] = (
    ASSUMED,
    replace(ASSUMED, name="back pressure 0.3 MPa", back_pressure=0.3e6),
    replace(ASSUMED, name="back pressure 3 MPa", back_pressure=3e6),
    replace(ASSUMED, name="both loads at 4.83 MPa before the step", load_pressure=rig.PRESSURE_ERROR_AT),
    replace(ASSUMED, name="volumes × 1", volumes=1.0),
    replace(ASSUMED, name="volumes × 100", volumes=100.0),
    replace(ASSUMED, name="source volume 0.1 L", source_volume=1e-4),
    replace(ASSUMED, name="source volume 10 L", source_volume=1e-2),
    replace(ASSUMED, name="friction 1 N", friction=1.0),
    replace(ASSUMED, name="friction 3 N", friction=3.0),
    replace(ASSUMED, name="friction 10 N", friction=10.0),
    replace(ASSUMED, name="warm oil, 15 mm²/s", viscosity=15e-6),
    replace(ASSUMED, name="load 1 raised", raised=True),
)
"""The first, and each of its assumptions changed by itself."""


@dataclass(frozen=True)
class Point:
    """What the model says where the rig measured.

    Attributes:
        error: (3.5) [%], signed, as the tables must be.
        dynamic: (3.10) [m^3].
        settling: [s].
        ratio: QL1/QL2 after the step.
        regulation: Change of QL1/(QL1 + QL2) over the step [%].
        loss: Pressure loss [Pa].
        drop: Over the fixed orifices before the step, mean of both, pilot line open [Pa].
        load_difference: After the step, at its end, the greater less the lesser [Pa].
        pilot_share: Of the source flow through the grooves.
        outcome: How it ended.
    """

    error: float
    dynamic: float
    settling: float
    ratio: float
    regulation: float
    loss: float
    drop: float
    load_difference: float
    pilot_share: float
    outcome: Outcome


def measure(
    formulation: str,
    assumed: Assumptions,
    rows: Sequence[tuple[float, float]],
    spool_position: float = CENTRED,
) -> list[Point]:
    """Simulate the prototype in the rig.

    Args:
        formulation: A name of `FORMULATIONS`.
        assumed: What the thesis does not say.
        rows: Stated drop over the fixed orifices, and stated load difference, both at half the source flow [Pa].
        spool_position: φ/φ0.
    """
    points = []
    for fixed_drop, load_difference in rows:
        response = respond_in_rig(formulation, assumed, fixed_drop, load_difference, spool_position)
        found, verdict = quantities_of(response)
        row = dict(zip(QUANTITIES, found.tolist(), strict=True))
        drop, difference = _came_out(response)
        points.append(
            Point(
                error=row["flow_difference"],
                dynamic=row["dynamic_error"],
                settling=row["settling_time"],
                ratio=row["load_flow_1"] / row["load_flow_2"],
                regulation=row["load_regulation"],
                loss=row["pressure_loss"],
                drop=drop,
                load_difference=difference,
                pilot_share=row["pilot_share"],
                outcome=verdict.outcome,
            )
        )
    return points


def respond_in_rig(
    formulation: str, assumed: Assumptions, fixed_drop: float, load_difference: float, spool_position: float = CENTRED
) -> Response:
    """Simulate one test; arguments as in `measure`."""
    scenario = _scenario(assumed, load_difference, spool_position)
    with one_thread():
        return respond(prototype(assumed, fixed_drop), FORMULATIONS[formulation], scenario, SETTINGS)


def _came_out(response: Response) -> tuple[float, float]:
    """Return the drop over the fixed orifices before the step and the load difference after it [Pa]."""
    before, after = response.phases[0].end, response.phases[-1].end
    if before is None or after is None:
        return math.nan, math.nan
    ps, pa = before[0], before[1:3]
    return float(ps - pa.mean()), float(abs(after[7] - after[8]))


def prototype(assumed: Assumptions, fixed_drop: float) -> dict[str, float]:
    """Return the parameters of B.2's valve with fixed orifices of another size in front of it.

    The ports stay those of the prototype: their share of the total drop at the design flow is kept, and the fixed
    orifices are sized for the stated drop [Pa] at half the tests' source flow.
    """
    drawn = parameter_set("thesis_prototype")
    ports = drawn["total_pressure_drop"] * (1 - drawn["fixed_drop_ratio"])
    orifices = fixed_drop * (drawn["design_flow"] / (rig.SOURCE_FLOW / 2)) ** 2
    return drawn | {
        "total_pressure_drop": orifices + ports,
        "fixed_drop_ratio": orifices / (orifices + ports),
        "chamber_length": drawn["chamber_length"] * assumed.volumes,
        "load_volume": drawn["load_volume"] * assumed.volumes,
        "source_volume": assumed.source_volume,
        "coulomb_friction": assumed.friction,
        "kinematic_viscosity": assumed.viscosity,
    }


def _scenario(assumed: Assumptions, load_difference: float, spool_position: float) -> Scenario:
    high = assumed.back_pressure + load_difference if assumed.load_pressure is None else assumed.load_pressure
    low = high - load_difference
    before, after = (low, high) if assumed.raised else (high, low)
    return Scenario(
        source_flow=rig.SOURCE_FLOW,
        spool_position=spool_position,
        load_pressures=(before, before),
        events=(load_step(1, after),),
        end_time=SECONDS,
    )
