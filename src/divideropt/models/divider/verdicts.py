"""The verdict on a response: what was found, in a sentence."""

import numpy as np

from divideropt.models.base import Outcome, Verdict
from divideropt.models.divider.equilibrium import stability_margin
from divideropt.models.divider.metric_kernels import REST_TOLERANCE
from divideropt.models.divider.oscillation import sustained_oscillation
from divideropt.models.divider.response import Response
from divideropt.models.divider.result_record import (
    AT_STOP,
    LIMIT_CYCLE,
    NO_EQUILIBRIUM,
    NOT_COMPLETED,
    SOUND,
    UNSETTLED,
    UNSTABLE,
)
from divideropt.models.divider.scenario import Scenario

OK = Verdict(Outcome.OK)


def verdict_of(judgement: np.record, scenario: Scenario) -> Verdict:
    """Return the verdict on a response of which the judgement alone is left.

    Args:
        judgement: `JUDGEMENT`; neither of a response that was not completed nor of a limit cycle.
        scenario: What happened.
    """
    finding, value = int(judgement["finding"]), float(judgement["value"])
    if finding == SOUND:
        return OK
    if finding == AT_STOP:
        text = f"the spool rests on its stop, {value * 1e3:.4g} mm from the centre: the flows are not controlled"
        return Verdict(Outcome.AT_STOP, text)
    if finding == NO_EQUILIBRIUM:
        text = f"no equilibrium within the stroke {_when(scenario, int(judgement['phase']))}"
        return Verdict(Outcome.NO_EQUILIBRIUM, text)
    if finding == UNSTABLE:
        return Verdict(Outcome.UNSTABLE, f"an equilibrium is unstable: a disturbance grows at {-value:.4g} 1/s")
    text = "the flow of branch 1 still leaves its 2 % band in the last tenth of the time"
    if finding == UNSETTLED:
        text = f"at the end a load flow is {100 * value:.3g} % from that of the equilibrium"
    return Verdict(Outcome.UNSETTLED, text)


def verdict_on(response: Response, judgement: np.record) -> Verdict:
    """Return the verdict on a response.

    Args:
        response: One design's response.
        judgement: `JUDGEMENT` of it.
    """
    if judgement["finding"] == NOT_COMPLETED:
        return _not_completed(response, int(judgement["phase"]))
    if judgement["finding"] == LIMIT_CYCLE:
        return _limit_cycle(response)
    return verdict_of(judgement, response.scenario)


def _not_completed(response: Response, phase: int) -> Verdict:
    run = response.phases[phase].trajectory
    assert run is not None
    text = f"the solver stopped at t = {run.edges[-1]:.6g} s ({run.status}): {run.message}"
    return Verdict(Outcome.NOT_COMPLETED, text)


def _limit_cycle(response: Response) -> Verdict:
    last = response.phases[-1]
    swing = sustained_oscillation(last, REST_TOLERANCE)
    assert swing is not None and last.rest is not None
    margin = stability_margin(last.design, last.rest.state)
    around = "an unstable equilibrium" if margin < 0.0 else "an equilibrium that is stable against small disturbances"
    text = (
        f"the flows never settle: branch 1 swings by {100 * swing.amplitude:.3g} % to either side, "
        f"{swing.frequency:.4g} times a second, around {around} (stability margin {margin:.4g} 1/s)"
    )
    return Verdict(Outcome.LIMIT_CYCLE, text)


def _when(scenario: Scenario, phase: int) -> str:
    event = scenario.spans()[phase].event
    if len(scenario.events) == 1:
        return "before the step" if event < 0 else "after the step"
    return "before the first event" if event < 0 else f"after event {event + 1}"
