"""The outcome of a response: the first thing wrong, the gravest first, in a sentence."""

import math
from collections.abc import Mapping

from divideropt.models.base import Outcome, Verdict
from divideropt.models.divider.equilibrium import rests_on_stop, stability_margin
from divideropt.models.divider.kernels import STATES
from divideropt.models.divider.oscillation import sustained_oscillation
from divideropt.models.divider.response import Phase, Response, distance_from_rest
from divideropt.ode import SolverStatus

REST_TOLERANCE = 1e-3
"""How near the flows at the end must be to the equilibrium's for a settled start to count as settled again."""

LAST_PART = 0.1
"""Where the final flows are the end's own, leaving the band in this last part of the time is unsettled."""

_X = STATES.index("x")


def judge(response: Response, found: Mapping[str, float]) -> Verdict:
    """Judge a response.

    Args:
        response: One design's response.
        found: Its quantities by name.

    Returns:
        The outcome, and what happened.
    """
    for check in (_not_completed, _limit_cycle, _at_stop, _no_equilibrium, _unstable, _unsettled):
        verdict = check(response, found)
        if verdict is not None:
            return verdict
    return Verdict(Outcome.OK)


def _not_completed(response: Response, found: Mapping[str, float]) -> Verdict | None:
    for phase in response.phases:
        run = phase.trajectory
        if run is not None and run.status is not SolverStatus.FINISHED:
            return Verdict(
                Outcome.NOT_COMPLETED,
                f"the solver stopped at t = {run.edges[-1]:.6g} s ({run.status}): {run.message}",
            )
    return None


def _limit_cycle(response: Response, found: Mapping[str, float]) -> Verdict | None:
    last = response.phases[-1]
    swing = sustained_oscillation(last, REST_TOLERANCE)
    if swing is None or last.rest is None:
        return None
    margin = stability_margin(last.design, last.rest.state)
    around = "an unstable equilibrium" if margin < 0.0 else "an equilibrium that is stable against small disturbances"
    text = (
        f"the flows never settle: branch 1 swings by {100 * swing.amplitude:.3g} % to either side, "
        f"{swing.frequency:.4g} times a second, around {around} (stability margin {margin:.4g} 1/s)"
    )
    return Verdict(Outcome.LIMIT_CYCLE, text)


def _at_stop(response: Response, found: Mapping[str, float]) -> Verdict | None:
    for phase in response.phases:
        places = [phase.end] if phase.rest is None else [phase.end, phase.rest.state]
        for state in places:
            if phase.end is not None and state is not None and rests_on_stop(phase.design, state):
                where = abs(state[_X]) * 1e3
                text = f"the spool rests on its stop, {where:.4g} mm from the centre: the flows are not controlled"
                return Verdict(Outcome.AT_STOP, text)
    return None


def _no_equilibrium(response: Response, found: Mapping[str, float]) -> Verdict | None:
    for phase in response.phases:
        if phase.rest is None and not phase.span.moving:
            text = f"no equilibrium within the stroke {_when(response, phase)}"
            return Verdict(Outcome.NO_EQUILIBRIUM, text)
    return None


def _when(response: Response, phase: Phase) -> str:
    if len(response.scenario.events) == 1:
        return "before the step" if phase.span.event < 0 else "after the step"
    return "before the first event" if phase.span.event < 0 else f"after event {phase.span.event + 1}"


def _unstable(response: Response, found: Mapping[str, float]) -> Verdict | None:
    margin = found["stability_margin"]
    if not margin < 0.0:  # NaN is not unstable
        return None
    return Verdict(Outcome.UNSTABLE, f"an equilibrium is unstable: a disturbance grows at {-margin:.4g} 1/s")


def _unsettled(response: Response, found: Mapping[str, float]) -> Verdict | None:
    last = response.phases[-1]
    if last.end is None or last.rest is None:
        return None
    if response.rests_at_root:
        off = distance_from_rest(last)
        settled = off <= REST_TOLERANCE and not math.isnan(found["settling_time"])
        text = f"at the end a load flow is {100 * off:.3g} % from that of the equilibrium"
    else:
        begin, end = response.scenario.last_event_time, response.scenario.end_time
        settled = found["settling_time"] <= (1 - LAST_PART) * (end - begin)
        text = "the flow of branch 1 still leaves its 2 % band in the last tenth of the time"
    return None if settled else Verdict(Outcome.UNSETTLED, text)
