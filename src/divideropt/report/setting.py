"""What made a report's figures, in words: formulation, parameters, scenarios, solver."""

from collections.abc import Mapping

from divideropt.campaign.config import Campaign
from divideropt.campaign.divider import DividerConfig
from divideropt.models.divider import Event, Scenario
from divideropt.models.divider.scenarios import BASE
from divideropt.report.display import axis_of
from divideropt.report.uncertainty import uncertainty_words


def setting_of(campaign: Campaign) -> tuple[tuple[str, str], ...]:
    """Word what was simulated, as pairs of a heading and a sentence."""
    model = campaign.model
    if not isinstance(model, DividerConfig):
        return (("Model", model.kind), *uncertainty_words(campaign))
    solver = model.solver
    scenarios = (
        ("Scenario" if name == BASE else f"Scenario {name}", _scenario_words(scenario) + _set_words(model, name))
        for name, scenario in model.all_scenarios().items()
    )
    loss = "; with the losses at the grooves' ends" if model.groove_loss == "entrance" else ""
    return (
        ("Model", "divider: the adjustable-ratio flow divider"),
        ("Formulation", model.formulation + loss),
        ("Parameters", _parameter_words(model)),
        *scenarios,
        *uncertainty_words(campaign),
        ("Solver", f"{solver.method}, relative tolerance {solver.rtol:g}, at most {solver.max_steps} steps"),
    )


def _scenario_words(scenario: Scenario) -> str:
    loads = " and ".join(f"{pressure / 1e6:g}" for pressure in scenario.load_pressures)
    start = "from rest" if scenario.settled else "from an empty valve"
    return (
        f"source flow {scenario.source_flow * 6e4:g} L/min, spool position φ/φ0 = {scenario.spool_position:g}, "
        f"loads {loads} MPa; {start}; {'; '.join(_event_words(event) for event in scenario.events)}; "
        f"end at {scenario.end_time:g} s"
    )


def _event_words(event: Event) -> str:
    changes = [f"load {i} to {p / 1e6:g} MPa" for i, p in enumerate(event.load_pressures, start=1) if p is not None]
    if event.source_flow is not None:
        changes.append(f"source flow to {event.source_flow * 6e4:g} L/min")
    if event.spool_position is not None:
        changes.append(f"φ/φ0 to {event.spool_position:g}")
    over = f" over {event.over * 1e3:g} ms" if event.over > 0.0 else ""
    return f"at {event.at * 1e3:g} ms {', '.join(changes)}{over}"


def _parameter_words(model: DividerConfig) -> str:
    return f"{model.parameters}, with {_values_words(model, model.set)}" if model.set else model.parameters


def _set_words(model: DividerConfig, scenario: str) -> str:
    changes = model.changes().get(scenario)
    return f"; with {_values_words(model, changes)}" if changes else ""


def _values_words(model: DividerConfig, values: Mapping[str, float]) -> str:
    parameters = model.tables().parameters or {}
    axes = {name: axis_of(parameters[name], [value]) for name, value in values.items()}
    return ", ".join(f"{axes[name].words} {axes[name].bound(value)}" for name, value in values.items())
