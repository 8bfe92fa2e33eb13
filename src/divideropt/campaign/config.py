"""A campaign: what is optimised, in what, by which strategies. Frozen, in SI, every default filled in."""

import re
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Self, TypeVar

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    PlainValidator,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import InitErrorDetails

from divideropt.campaign import schemas
from divideropt.campaign.divider import DividerConfig
from divideropt.campaign.fields import POSITIVE, GivenMeasure, Measure, by_name, measure_of
from divideropt.campaign.nominal import nominal_rules
from divideropt.campaign.parallel import ParallelConfig
from divideropt.campaign.plans import StrategyPlan, is_study, needs_goals, plans_schema, read_plans
from divideropt.campaign.plugin import PluginConfig
from divideropt.campaign.ranges import read_range
from divideropt.campaign.sections import Section, mistake, section_of, show, together
from divideropt.campaign.sensitivity import SensitivityConfig
from divideropt.campaign.termination import termination_rules
from divideropt.campaign.uncertainty import (
    StatisticWord,
    UncertaintyConfig,
    check_uncertainty,
    uncertainty_rules,
)
from divideropt.campaign.worst_case import named_scenarios, read_worst_of, worst_case_rules
from divideropt.models import Quantity

S = TypeVar("S", "ObjectiveConfig", "ConstraintConfig")

_DEVICE = r"([cC][oO][nN]|[pP][rR][nN]|[aA][uU][xX]|[nN][uU][lL]|[cC][oO][mM][0-9]|[lL][pP][tT][0-9])$"
"""Names that Windows keeps for devices: no folder there can have one, and a store may be copied to it."""

_NAME = re.compile(rf"(?!{_DEVICE})[A-Za-z0-9][A-Za-z0-9_-]{{0,63}}", re.ASCII)


def _nonzero(goal: float) -> float:
    if goal == 0.0:
        raise ValueError(
            "a goal of 0 is not permitted, since (3.24) divides by it; give the least that would satisfy"
        )
    return goal


class ObjectiveConfig(Section):
    """A quantity to be minimised, a signed one by its magnitude. Read by `Campaign`, which has the unit."""

    goal: Annotated[float, GivenMeasure(), AfterValidator(_nonzero)] | None = None
    """F* of (3.24), in the quantity's unit."""
    weight: Annotated[float, Measure("", POSITIVE)] = 1.0
    """w of (3.24)."""
    worst_of: Annotated[tuple[str, ...], BeforeValidator(read_worst_of)] = ()
    """Scenarios over which the quantity's largest value counts; `scenario` is the model's own, `all` every one."""
    statistic: StatisticWord | None = None
    """Which statistic over the samples of `uncertainty` counts; without one the design as it is."""


class ConstraintConfig(Section):
    """Inclusive bounds of a quantity, of a signed one's magnitude. Read by `Campaign`, which has the unit."""

    min: Annotated[float, GivenMeasure()] | None = None
    """Lower bound, in the quantity's unit."""
    max: Annotated[float, GivenMeasure()] | None = None
    """Upper bound, in the quantity's unit."""
    worst_of: Annotated[tuple[str, ...], BeforeValidator(read_worst_of)] = ()
    """Scenarios in all of which the bounds are kept; `scenario` is the model's own, `all` every one."""
    statistic: StatisticWord | None = None
    """Which statistic over the samples of `uncertainty` keeps them; without one the design as it is."""

    @model_validator(mode="after")
    def _bounds(self) -> Self:
        if self.min is None and self.max is None:
            raise ValueError("the constraint has no bound; give `min`, `max` or both")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError(f"min is above max ({self.min:g} > {self.max:g}), so nothing is feasible; exchange them")
        return self


class VerificationConfig(Section):
    """Which front points `divideropt run` simulates again by the model's reference, and what counts as the same.

    `divideropt verify` does all.
    """

    sample: Annotated[int, Field(strict=True, ge=0, le=10**6)] = 50
    """How many of the other points of the combined front, drawn at random with a fixed seed."""
    extremes: Annotated[bool, Field(strict=True)] = True
    """Whether the extremes of each objective and the points nearest the goals are."""
    tolerance: Annotated[float, Measure("%", POSITIVE)] = 1.0
    """Largest deviation of an objective from the reference's, of which it is a share."""

    @property
    def share(self) -> float:
        """The tolerance as a part of 1, as deviations are."""
        return self.tolerance / 100.0


class OptimalityConfig(Section):
    """Of which front points `divideropt run` simulates the neighbours, for the residual of the KKT conditions."""

    points: Annotated[int, Field(strict=True, ge=0, le=10**6)]
    """How many of the combined front, drawn at random with a fixed seed, besides its extremes and the points nearest
    the goals; 0 for none at all. Each takes four simulations a variable, and four."""


FEW_POINTS = 200
"""Of which neighbours are simulated where a campaign does not say: some seconds by the valve's compiled solver."""


def _affordable(model: object, uncertainty: object) -> OptimalityConfig:
    """By another solver a simulation takes dozens of times as long; by a model of somebody's own perhaps minutes.

    Under uncertainty each design is simulated as often as there are samples.
    """
    quick = isinstance(model, DividerConfig) and model.solver.method == "rosenbrock" and uncertainty is None
    return OptimalityConfig(points=FEW_POINTS if quick else 0)


def names_folder(name: str) -> bool:
    """Whether a campaign can be called so: its folder of results has this name."""
    return _NAME.fullmatch(name) is not None


def _name(value: object) -> str:
    if not isinstance(value, str) or not names_folder(value):
        raise ValueError(
            f"{show(value)} cannot name the folder of results; use 1 to 64 of A-Z, a-z, 0-9, - and _, "
            "a letter or digit first, in quotes if it looks like a number, and no device's name such as con"
        )
    return value


def _model(value: Any, info: ValidationInfo) -> DividerConfig | PluginConfig:
    section = PluginConfig if names_plugin(value) else DividerConfig
    return section.model_validate(value, context=info.context)


def names_plugin(model: object) -> bool:
    """Whether a `model` section, as written, names a class of the user's own."""
    return isinstance(model, Mapping) and isinstance(model.get("kind"), str) and ":" in model["kind"]


def _objective(quantity: Quantity, raw: object) -> ObjectiveConfig:
    return ObjectiveConfig.model_validate({} if raw is None else raw, context=measure_of(quantity))


def _constraint(quantity: Quantity, raw: object) -> ConstraintConfig:
    return ConstraintConfig.model_validate(raw, context=measure_of(quantity))


def _with_names(sections: Mapping[str, S], info: ValidationInfo) -> dict[str, S]:
    """Name the scenarios of objectives or constraints that are over all."""
    model = info.data.get("model")
    return {
        name: section.model_copy(update={"worst_of": named_scenarios(section.worst_of, model)})
        for name, section in sections.items()
    }


def _reference_value(quantity: Quantity, raw: object) -> float:
    value = measure_of(quantity).read(raw)
    if value <= 0.0:
        raise ValueError(f"{show(raw)} is not above 0, from where the hypervolume is measured; give a worse value")
    return value


def _reference(value: Any, info: ValidationInfo) -> dict[str, float]:
    """Read the reference point: nothing, or a value for every objective."""
    point = by_name("quantities", _reference_value)(value, info)
    objectives = info.data.get("objectives")
    if not point or not objectives:
        return point
    found = [
        mistake((name,), f"{name} is not an objective, so it has no place here; delete it", at_key=True)
        for name in point
        if name not in objectives
    ]
    lacking = [name for name in objectives if name not in point]
    if lacking:
        found.append(mistake((), f"{', '.join(lacking)} is lacking; give a value for every objective", at_key=True))
    if found:
        raise together(found)
    return point


class Campaign(Section):
    """A campaign as resolved; `divideropt.campaign.load.load_campaign` reads one."""

    name: Annotated[str, PlainValidator(_name), WithJsonSchema({"type": "string", "pattern": f"^{_NAME.pattern}$"})]
    """Names the folder of results."""
    model: Annotated[DividerConfig | PluginConfig, PlainValidator(_model, json_schema_input_type=DividerConfig)]
    """What is optimised."""
    variables: Annotated[
        Mapping[str, tuple[float, float]],
        PlainValidator(by_name("parameters", read_range, least=1)),
        WithJsonSchema(schemas.variables()),
    ]
    """Lower and upper bound of each parameter that varies, in its unit."""
    objectives: Annotated[
        Mapping[str, ObjectiveConfig],
        PlainValidator(by_name("quantities", _objective, least=1)),
        AfterValidator(_with_names),
        WithJsonSchema(schemas.objectives()),
    ]
    """What is minimised."""
    constraints: Annotated[
        Mapping[str, ConstraintConfig],
        PlainValidator(by_name("quantities", _constraint)),
        AfterValidator(_with_names),
        WithJsonSchema(schemas.constraints()),
    ] = Field(default_factory=dict)
    """What a feasible design keeps."""
    reference_point: Annotated[
        Mapping[str, float], PlainValidator(_reference), WithJsonSchema(schemas.reference_point())
    ] = Field(default_factory=dict)
    """Where the hypervolume is measured from: nothing, or a value for every objective."""
    uncertainty: Annotated[UncertaintyConfig | None, AfterValidator(check_uncertainty)] = None
    """Which parameters are uncertain, and how; without it every design is simulated as it is."""
    strategies: Annotated[tuple[StrategyPlan, ...], PlainValidator(read_plans), WithJsonSchema(plans_schema())]
    """What runs, in this order."""
    nominal: Annotated[bool, Field(strict=True)] = False
    """Whether a companion without scenarios and uncertainty runs too, to say what these cost."""
    verification: VerificationConfig = VerificationConfig()
    """Which front points are simulated again."""
    optimality: OptimalityConfig = Field(default_factory=lambda data: _affordable(data["model"], data["uncertainty"]))
    """How near to stationary front points are; 200 points by the valve's compiled solver, none where that is dear."""
    sensitivity: SensitivityConfig = SensitivityConfig()
    """What `divideropt sensitivity` varies, and how it samples that."""
    parallel: ParallelConfig = ParallelConfig()
    """How the work is spread."""

    @classmethod
    def rules(cls, raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
        """Say what does not fit together between sections."""
        fixed = section_of(section_of(raw, "model"), "set")
        varying = () if is_study(section_of(raw, "strategies")) else section_of(raw, "variables")
        for name in varying:
            if name in fixed:
                sentence = f"{name} is in model.set too, and cannot both vary and be fixed; delete one of the two"
                yield mistake(("variables", name), sentence, at_key=True)
        yield from _scenario_set_rules(raw)
        yield from worst_case_rules(raw)
        yield from uncertainty_rules(raw)
        yield from nominal_rules(raw)
        yield from termination_rules(raw)
        aggregating = ", ".join(name for name in section_of(raw, "strategies") if needs_goals(name))
        for name, objective in section_of(raw, "objectives").items():
            given = objective.get("goal") if isinstance(objective, Mapping) else None
            if aggregating and given is None:
                sentence = f"{name} has no goal, by which {aggregating} weighs the objectives; give one, {{goal: …}}"
                yield mistake(("objectives", name), sentence, at_key=True)


def _scenario_set_rules(raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
    """Say what varies, in the campaign or in a study of it, and is set by a scenario: it would vary in the others."""
    scenarios, variables = section_of(section_of(raw, "model"), "scenarios"), section_of(raw, "variables")
    studied = section_of(section_of(raw, "sensitivity"), "parameters")
    for scenario in scenarios:
        for name in section_of(section_of(scenarios, scenario), "set"):
            place = ("model", "scenarios", scenario, "set", name)
            if name in variables:
                sentence = f"{name} is a variable, which no scenario can set; delete it here, or from `variables`"
                yield mistake(place, sentence, at_key=True)
            elif name in studied:
                sentence = f"{name} is studied, which no scenario can set; delete it here, or from `sensitivity`"
                yield mistake(place, sentence, at_key=True)
