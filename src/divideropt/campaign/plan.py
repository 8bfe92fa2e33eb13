"""A campaign to what is run: the problem, and one run a strategy and seed. Pure."""

from dataclasses import dataclass

import numpy as np

from divideropt.campaign.config import Campaign
from divideropt.campaign.divider import DividerConfig
from divideropt.models import Model
from divideropt.models.base import FloatArray
from divideropt.models.divider import Divider
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
    """

    name: str
    strategy: str
    options: Strategy
    seed: int


def plan_runs(campaign: Campaign) -> tuple[Run, ...]:
    """List the runs, in the campaign's order."""
    return tuple(
        Run(f"{plan.name}-{seed}", plan.name, plan.options, seed)
        for plan in campaign.strategies
        for seed in plan.seeds
    )


def build_model(campaign: Campaign) -> Model:
    """Make the campaign's model."""
    config = campaign.model
    if isinstance(config, DividerConfig):
        return Divider(config.formulation, config.scenario.to_scenario(), config.solver.to_settings())
    return config.make()


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
        objectives=tuple(Objective(quantities[name], o.goal, o.weight) for name, o in campaign.objectives.items()),
        constraints=tuple(Constraint(quantities[name], c.min, c.max) for name, c in campaign.constraints.items()),
    )


def reference_of(campaign: Campaign) -> FloatArray | None:
    """The reference point of the hypervolume in the objectives' order, shape (k,), or None."""
    if not campaign.reference_point:
        return None
    return np.array([campaign.reference_point[name] for name in campaign.objectives])
