"""The `uncertainty` section of a campaign, and `statistic` in objectives and constraints: read, and made a model."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, PlainValidator, ValidationInfo, WithJsonSchema
from pydantic_core import InitErrorDetails

from divideropt.campaign import schemas
from divideropt.campaign.distributions import read_source, source_schema, written_source
from divideropt.campaign.fields import Tables, by_name
from divideropt.campaign.sections import Section, mistake, section_of, show, together
from divideropt.campaign.worst_case import gathered_name
from divideropt.models import Model, Parameter, Quantity
from divideropt.models.divider.parameters import PARAMETERS
from divideropt.models.statistic import KINDS, MEAN, Statistic, is_kind, parted, percent_of
from divideropt.models.uncertain import FAILED_SHARE, Source, under_uncertainty

if TYPE_CHECKING:
    from divideropt.campaign.config import Campaign, ConstraintConfig, ObjectiveConfig

MOST_SAMPLES = 10_000
"""More are a slip: each simulates every design once more."""

LARGEST_SEED = 2**32 - 1

SHOWN = (MEAN, "p5", "p50", "p95")
"""Statistics that every objective's quantity has."""


def _read_statistic(value: object) -> str:
    if not isinstance(value, str) or not is_kind(value):
        raise ValueError(
            f"{show(value)} is no statistic; write mean, sd or a percentile from p0 to p100, such as p95"
        )
    return value


StatisticWord = Annotated[
    str, PlainValidator(_read_statistic), WithJsonSchema({"type": "string", "pattern": rf"^({KINDS})$"})
]
"""`mean`, `sd`, `p95`, `p99.5`."""


class UncertaintyConfig(Section):
    """Parameters that no design can be sure of, and in how many samples of them each is simulated."""

    samples: Annotated[int, Field(strict=True, ge=2, le=MOST_SAMPLES)] = 64
    """Simulations of each design besides the one as it is, the same sample for every design; best a power of 2."""
    seed: Annotated[int, Field(strict=True, ge=0, le=LARGEST_SEED)] = 1
    """Of the sample."""
    parameters: Annotated[
        Mapping[str, Source],
        PlainValidator(by_name("parameters", read_source, least=1)),
        WithJsonSchema(schemas.uncertain({p.name: source_schema(p) for p in PARAMETERS.values()})),
    ]
    """The distribution of each uncertain parameter."""

    def as_written(self, parameters: Mapping[str, Parameter]) -> dict[str, Any]:
        """Return it as a campaign's file has it; `parameters` are the model's."""
        written = {name: written_source(parameters[name], source) for name, source in self.parameters.items()}
        return {"samples": self.samples, "seed": self.seed, "parameters": written}


def with_failures(tables: Tables, uncertain: bool) -> Tables:
    """Add to the names a campaign may use the share of samples that fail, where it has samples."""
    if not uncertain or tables.quantities is None:
        return tables
    return Tables(tables.parameters, {FAILED_SHARE.name: FAILED_SHARE, **tables.quantities})


def check_uncertainty(uncertainty: UncertaintyConfig | None, info: ValidationInfo) -> UncertaintyConfig | None:
    """Check the section against the sections before it, for pydantic; raises ValidationError with every mistake."""
    model, variables = info.data.get("model"), info.data.get("variables")
    if uncertainty is None or model is None or variables is None:
        return uncertainty
    tables: Tables = info.context or Tables()
    found = list(_taken_names(tables.quantities or {}))
    model_parameters = tables.parameters or {}
    own = {name: (value, value) for name, value in model.base_parameters().items()} | dict(variables)
    for name, source in uncertainty.parameters.items():
        parameter = model_parameters[name]
        objections = _objections(parameter, source, own[name], varies=name in variables)
        found += [mistake(("parameters", name), sentence, at_key=True) for sentence in objections]
    if found:
        raise together(found)
    return uncertainty


def uncertainty_rules(raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
    """Say what is wrong with every `statistic`, and with what scenarios set, judged on the campaign as written."""
    uncertainty = raw.get("uncertainty")
    for section in ("objectives", "constraints"):
        for name, entry in section_of(raw, section).items():
            if not isinstance(entry, Mapping) or entry.get("statistic") is None:
                continue
            where = (section, name, "statistic")
            if uncertainty is None:
                sentence = "there is no `uncertainty`, of whose samples it could be; add that section, or delete it"
                yield mistake(where, sentence, at_key=True)
            elif name == FAILED_SHARE.name:
                yield mistake(where, f"{name} is of all samples together; delete it", at_key=True)
            elif is_kind(entry["statistic"]):
                yield from _side_rules(where, entry)
                if section == "constraints":
                    yield from _both_ways(where, entry, section_of(raw, "objectives").get(name))
    uncertain = section_of(section_of(raw, "uncertainty"), "parameters")
    scenarios = section_of(section_of(raw, "model"), "scenarios")
    for scenario in scenarios:
        for name in section_of(section_of(scenarios, scenario), "set"):
            if name in uncertain:
                sentence = f"{name} is uncertain, which no scenario can set; delete it here, or from `uncertainty`"
                yield mistake(("model", "scenarios", scenario, "set", name), sentence, at_key=True)


def counted_name(quantity: str, entry: "ObjectiveConfig | ConstraintConfig", *, least: bool = False) -> str:
    """Name of the quantity on which an objective or a constraint acts: `p95.worst.settling_time`, or itself."""
    gathered = gathered_name(quantity, entry.worst_of, least=least)
    return Statistic(gathered, entry.statistic).name if entry.statistic else gathered


def uncertain_model(campaign: "Campaign", model: Model) -> Model:
    """Put a campaign's uncertainty around its model; without uncertainty it is the model."""
    asked = campaign.uncertainty
    if asked is None:
        return model
    plain = dict.fromkeys(gathered_name(name, o.worst_of) for name, o in campaign.objectives.items())
    shown = [Statistic(name, kind) for name in plain if name != FAILED_SHARE.name for kind in SHOWN]
    return under_uncertainty(
        model, list(asked.parameters.values()), asked.samples, asked.seed, list(_needed(campaign)), shown
    )


def _needed(campaign: "Campaign") -> Iterator[Statistic]:
    """List the statistics of a campaign's objectives and constraints."""
    for name, o in campaign.objectives.items():
        if o.statistic:
            yield Statistic(gathered_name(name, o.worst_of), o.statistic)
    for name, c in campaign.constraints.items():
        for least, bound in ((True, c.min), (False, c.max)):
            if c.statistic and bound is not None:
                yield Statistic(gathered_name(name, c.worst_of, least=least), c.statistic, least)


def _side_rules(where: tuple[str, ...], entry: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
    """Refuse a percentile that bounds the few samples instead of the many."""
    kind = entry["statistic"]
    percent = percent_of(kind)
    for bound, falls, wrong in (
        ("min", "below", percent is not None and percent > 50.0),
        ("max", "above", percent is not None and percent < 50.0),
    ):
        if wrong and percent is not None and entry.get(bound) is not None:
            mirrored = 100.0 - percent
            outside = percent if bound == "min" else mirrored
            sentence = f"with {bound}, {kind} lets {outside:g} % of the samples be {falls} it; write p{mirrored:g}"
            yield mistake(where, sentence)


def _both_ways(where: tuple[str, ...], bound: Mapping[str, Any], objective: object) -> Iterator[InitErrorDetails]:
    """Refuse one percentile of one quantity under a lower bound and as something to be small.

    It is one column, in which a failed sample would have to be below and above all others. Over several scenarios
    they are two, the least and the worst.
    """
    kind = bound["statistic"]
    if percent_of(kind) is None or bound.get("min") is None or bound.get("worst_of"):
        return
    minimised = (
        isinstance(objective, Mapping) and objective.get("statistic") == kind and not objective.get("worst_of")
    )
    if bound.get("max") is not None or minimised:
        bounded = bound.get("max") is not None
        remedy = "leave one of the two out" if bounded else "take another percentile in one of the two"
        sentence = f"{kind} has a min and {'a max' if bounded else 'is an objective'}"
        yield mistake(where, f"{sentence}, and a failed sample cannot be both too small and too large; {remedy}")


def _objections(parameter: Parameter, source: Source, own: tuple[float, float], *, varies: bool) -> Iterator[str]:
    """Say why a parameter whose own value is within two ends cannot be uncertain so."""
    drawn = source.distribution
    if source.acting == "value":
        if varies:
            yield f"{parameter.name} is a variable, whose value a strategy gives; write an offset or a factor to it"
        return
    values = [a + b if source.acting == "offset" else a * b for a in own for b in (drawn.lower, drawn.upper)]
    beyond = [value for value in values if not parameter.domain.contains(value)]
    if beyond:
        yield (
            f"{parameter.name} would be as far as {beyond[0]:g} {parameter.unit}".rstrip()
            + f", but must be {parameter.domain}; narrow the {source.acting}"
            + (", or the variable's range" if varies else "")
        )


def _taken_names(quantities: Mapping[str, Quantity]) -> Iterator[InitErrorDetails]:
    """Say which quantities of a model have the names that statistics make."""
    for name, quantity in quantities.items():
        parts = parted(name)
        if (parts and parts[1] in quantities) or (name == FAILED_SHARE.name and quantity is not FAILED_SHARE):
            sentence = (
                f"the model has a quantity {name}, which would be a statistic's name; rename it, or its scenario"
            )
            yield mistake((), sentence, at_key=True)
            return
