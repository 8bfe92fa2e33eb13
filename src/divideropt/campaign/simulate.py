"""One response as a table: the work of `divideropt simulate`."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from divideropt.campaign.config import Campaign
from divideropt.campaign.divider import DividerConfig
from divideropt.campaign.plan import build_model, dividers
from divideropt.campaign.sections import nearest
from divideropt.errors import UsageError
from divideropt.models import Outcome, Parameter, Verdict
from divideropt.models.base import FloatArray
from divideropt.models.divider import PARAMETERS, Divider
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.response import Response
from divideropt.models.divider.scenarios import BASE
from divideropt.problem import one_thread
from divideropt.units import parse_measure

POINTS_PER_STEP = 16
"""Rows of a table for each step the solver took."""

COLUMNS = {
    "time": "s",
    "source_pressure": "Pa",
    "intermediate_pressure_1": "Pa",
    "intermediate_pressure_2": "Pa",
    "end_pressure_1": "Pa",
    "end_pressure_2": "Pa",
    "spool_velocity": "m/s",
    "spool_displacement": "m",
    "load_pressure_1": "Pa",
    "load_pressure_2": "Pa",
    "load_flow_1": "m^3/s",
    "load_flow_2": "m^3/s",
}
"""The columns of a response's table, in their order, with units: time, the nine states, the load flows."""


@dataclass(frozen=True)
class SimulatedResponse:
    """One design's response.

    Attributes:
        table: Columns as in `COLUMNS`, one row an instant.
        verdict: How the simulation ended.
        scenario: Name of the scenario.
        model: Who simulated it, whose `parameters` and `quantities` have units, symbols and descriptions.
        parameters: Every parameter of the design, in its unit.
        quantities: Every metric in its unit; NaN where it is not defined.
    """

    table: pd.DataFrame
    verdict: Verdict
    scenario: str
    model: Divider
    parameters: Mapping[str, float]
    quantities: Mapping[str, float]


def simulate(campaign: Campaign, settings: Sequence[str], scenario: str = BASE) -> SimulatedResponse:
    """Simulate one design of a campaign.

    Args:
        campaign: Whose model, scenario and parameters.
        settings: `NAME=VALUE` with a unit, for parameters that differ.
        scenario: Under which of the campaign's scenarios.

    Returns:
        The response.

    Raises:
        UsageError: A setting is no parameter, or out of its domain; or the model has no response to show.
    """
    model, parameters = chosen_design(campaign, settings, scenario)
    try:
        with one_thread(), np.errstate(all="ignore"):  # a failed design says so by its outcome
            response = model.respond(parameters)
            row, verdict = measure(response)
            table = _table(response)
    except (ArithmeticError, ValueError) as error:  # dimensions that no valve has
        table, verdict = pd.DataFrame(columns=list(COLUMNS), dtype=float), crashed(error)
        row = np.full(len(model.quantities), np.nan)
    quantities = dict(zip(model.quantities, row.tolist(), strict=True))
    return SimulatedResponse(table, verdict, scenario, model, parameters, quantities)


def response_data(response: SimulatedResponse) -> dict[str, Any]:
    """Return what a program reads of a response: outcome, parameters and metrics with their units, as plain data."""
    known = response.model.quantities
    return {
        "scenario": response.scenario,
        "outcome": str(response.verdict.outcome),
        "text": response.verdict.text,
        "parameters": {
            name: {"value": value, "unit": response.model.parameters[name].unit}
            for name, value in response.parameters.items()
        },
        "quantities": {
            name: {"value": _shown(value, logical=known[name].logical), "unit": known[name].unit}
            for name, value in response.quantities.items()
        },
    }


def _shown(value: float, *, logical: bool) -> float | bool | None:
    """A metric as a program reads it: None where it is not defined, yes or no where it is 1 or 0."""
    if np.isnan(value):
        return None
    return bool(value) if logical else value


def crashed(error: Exception) -> Verdict:
    """Word an exception of the model's as an outcome."""
    return Verdict(Outcome.CRASHED, f"the model broke down: {type(error).__name__}: {error}")


def chosen_design(campaign: Campaign, settings: Sequence[str], scenario: str) -> tuple[Divider, dict[str, float]]:
    """Return a campaign's divider under a scenario, and one design's parameters by name, SI.

    Args:
        campaign: Whose model, scenario and parameters.
        settings: `NAME=VALUE` with a unit, for parameters that differ.
        scenario: Name of the scenario.

    Raises:
        UsageError: A setting is no parameter, out of its domain, or given twice; there is no such scenario; or the
            model is not the divider.
    """
    models = dividers(build_model(campaign))
    if not models:
        raise UsageError("this campaign's model is a plug-in, which has no response to show; see `evaluate`")
    if scenario not in models:
        raise UsageError(f"--scenario {scenario}: the campaign has {', '.join(models)}; name one of them")
    model = models[scenario]
    return model, _parameters_under(campaign, scenario) | read_settings(settings, PARAMETERS)


def read_settings(settings: Sequence[str], known: Mapping[str, Parameter]) -> dict[str, float]:
    """Read `NAME=VALUE` with a unit to parameters by name, in their units.

    Raises:
        UsageError: One is no parameter, out of its domain, or given twice.
    """
    given = [_read(setting, known) for setting in settings]
    twice = [name for name, count in Counter(name for name, _ in given).items() if count > 1]
    if twice:
        raise UsageError(f"--set {twice[0]}: given more than once; say it once")
    return dict(given)


def _parameters_under(campaign: Campaign, scenario: str) -> dict[str, float]:
    """Every parameter of a campaign as one of its scenarios has it, by name, SI."""
    config = campaign.model
    changes = config.changes() if isinstance(config, DividerConfig) else {}
    return config.base_parameters() | changes.get(scenario, {})


def _table(response: Response) -> pd.DataFrame:
    blocks = [np.empty((0, len(COLUMNS)))]
    for phase in response.phases:
        if phase.trajectory is not None:
            times = _times(phase.trajectory.edges)
            states = phase.trajectory.at(times)
            blocks.append(np.column_stack([times, states, phase.load_flows(states, times)]))
    return pd.DataFrame(np.concatenate(blocks), columns=list(COLUMNS))


def _times(edges: FloatArray) -> FloatArray:
    """Spread instants evenly over each step, edges included."""
    places = np.arange(POINTS_PER_STEP) / POINTS_PER_STEP
    return np.append((edges[:-1, None] + np.diff(edges)[:, None] * places).ravel(), edges[-1])


def _read(setting: str, known: Mapping[str, Parameter]) -> tuple[str, float]:
    name, equals, text = setting.partition("=")
    name = name.strip()
    if not equals:
        raise UsageError(f"--set {setting}: there is no =; write NAME=VALUE, such as spool_radius='9 mm'")
    if name not in known:
        meant = nearest(name, known)
        remedy = f"did you mean {meant}?" if meant else f"use one of {', '.join(known)}"
        raise UsageError(f"--set {setting}: {name!r} is no parameter; {remedy}")
    parameter = known[name]
    try:
        value = parse_measure(text.strip(), parameter.unit)
    except ValueError as error:
        raise UsageError(f"--set {setting}: {error}") from None
    if not parameter.domain.contains(value):
        raise UsageError(f"--set {setting}: {name} must be {parameter.domain} {parameter.unit}".rstrip())
    return name, value
