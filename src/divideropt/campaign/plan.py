"""A campaign to what is run: the problem, and one run a strategy and seed. Pure."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from divideropt.campaign.config import Campaign
from divideropt.campaign.divider import DividerConfig
from divideropt.campaign.termination import TerminationConfig
from divideropt.campaign.uncertainty import counted_name, uncertain_model
from divideropt.campaign.worst_case import worst_cases
from divideropt.models import Model, Quantity, divider
from divideropt.models.base import FloatArray
from divideropt.models.dimensions import Dimensioned
from divideropt.models.divider.scenarios import BASE, Scenarios
from divideropt.models.uncertain import Uncertain
from divideropt.problem import Constraint, DesignSpace, Objective, Problem, Variable
from divideropt.strategies import Strategy


@dataclass(frozen=True)
class Run:
    """One strategy with one seed.

    Attributes:
        name: Names its log and its front: `nsga2-1`.
        strategy: The strategy's name.
        options: The strategy.
        seed: Its seed.
        budget: Most evaluations it asks for.
        termination: By which rules it ends before its budget is spent; None by none.
    """

    name: str
    strategy: str
    options: Strategy
    seed: int
    budget: int
    termination: TerminationConfig | None = None


def plan_runs(campaign: Campaign) -> tuple[Run, ...]:
    """List the runs, in the campaign's order."""
    variables = len(campaign.variables)
    return tuple(
        Run(f"{plan.name}-{seed}", plan.name, plan.options, seed, plan.options.budget(variables), plan.termination)
        for plan in campaign.strategies
        for seed in plan.seeds
    )


def plan_data(campaign: Campaign) -> dict[str, Any]:
    """Return what a campaign would run, as plain data for a program."""
    runs = plan_runs(campaign)
    return {
        "name": campaign.name,
        "variables": list(campaign.variables),
        "objectives": list(campaign.objectives),
        "constraints": list(campaign.constraints),
        "nominal": campaign.nominal,
        "budget": sum(run.budget for run in runs),
        "runs": [{"run": r.name, "strategy": r.strategy, "seed": r.seed, "budget": r.budget} for r in runs],
    }


def build_model(campaign: Campaign) -> Model:
    """Make the campaign's model, with its scenarios and its uncertainty."""
    return uncertain_model(campaign, _certain_model(campaign))


def _certain_model(campaign: Campaign) -> Model:
    """Make the campaign's model without its uncertainty."""
    config = campaign.model
    if not isinstance(config, DividerConfig):
        return config.make()
    models = {
        name: divider.Divider(
            config.formulation, scenario, config.solver.to_settings(), config.groove_loss == "entrance"
        )
        for name, scenario in config.all_scenarios().items()
    }
    worst = worst_cases(campaign)
    return Scenarios(models, worst, config.changes()) if worst or len(models) > 1 else models[BASE]


def dividers(model: Model) -> Mapping[str, "divider.Divider"]:
    """Return the divider under each scenario by name, the campaign's own first; nothing for another model."""
    if isinstance(model, Uncertain):
        return dividers(model.model)
    if isinstance(model, Scenarios):
        return model.models
    return {BASE: model} if isinstance(model, divider.Divider) else {}


def dimensioned(model: Model) -> Dimensioned | None:
    """Return the model, without uncertainty and scenarios, if it offers dimensions and a sketch; else None."""
    if isinstance(model, Uncertain):
        return dimensioned(model.model)
    if isinstance(model, Scenarios):
        return model.base
    return model if isinstance(model, Dimensioned) else None


def build_problem(campaign: Campaign) -> Problem:
    """Make the campaign's problem."""
    model = build_model(campaign)
    quantities = model.quantities
    return Problem(
        model=model,
        fixed=campaign.model.base_parameters(),
        space=DesignSpace(
            tuple(Variable(model.parameters[name], *bounds) for name, bounds in campaign.variables.items())
        ),
        objectives=tuple(
            Objective(quantities[counted_name(name, o)], o.goal, o.weight) for name, o in campaign.objectives.items()
        ),
        constraints=tuple(_constraints(campaign, quantities)),
    )


def _constraints(campaign: Campaign, quantities: Mapping[str, Quantity]) -> Iterator[Constraint]:
    """Make the constraints; the two bounds of one over several scenarios are on two quantities."""
    for name, c in campaign.constraints.items():
        if not c.worst_of:
            yield Constraint(quantities[counted_name(name, c)], c.min, c.max)
            continue
        if c.min is not None:
            yield Constraint(quantities[counted_name(name, c, least=True)], c.min, None)
        if c.max is not None:
            yield Constraint(quantities[counted_name(name, c)], None, c.max)


def reference_of(campaign: Campaign) -> FloatArray | None:
    """The reference point of the hypervolume in the objectives' order, shape (k,), or None."""
    if not campaign.reference_point:
        return None
    return np.array([campaign.reference_point[name] for name in campaign.objectives])
