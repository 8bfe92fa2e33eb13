"""A campaign without its scenarios and its uncertainty: the companion that says what these cost."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic_core import InitErrorDetails

from divideropt.campaign.schemas import EVERY
from divideropt.campaign.sections import mistake, section_of
from divideropt.models.divider.scenarios import BASE
from divideropt.models.uncertain import FAILED_SHARE

if TYPE_CHECKING:
    from divideropt.campaign.config import Campaign, ConstraintConfig, ObjectiveConfig

S = TypeVar("S", "ObjectiveConfig", "ConstraintConfig")

SUFFIX = "-nominal"
"""Ends the companion's name."""

LONGEST_NAME = 64
"""Letters that a campaign's name may have."""

_SHARED = (
    "model",
    "variables",
    "objectives",
    "constraints",
    "reference_point",
    "strategies",
    "verification",
    "optimality",
    "parallel",
)
"""Sections that the companion has from its campaign, as far as they are of the base scenario; others are as in a
campaign that says nothing of them."""

_PLAIN = {"objectives": ("goal", "weight"), "constraints": ("min", "max")}
"""What the entries of a section may say of a quantity as it is; all else gathers it over something."""


def nominal_campaign(campaign: "Campaign") -> "Campaign":
    """Derive the companion of a campaign.

    Args:
        campaign: As resolved.

    Returns:
        The same model, variables, strategies and goals, with the objectives and constraints on plain quantities of
        the base scenario; what is asked of a named scenario alone, or of the samples alone, is left out.
    """
    fields = type(campaign).model_fields
    update: dict[str, Any] = {
        name: field.get_default(call_default_factory=True, validated_data=dict(campaign))
        for name, field in fields.items()
        if name not in {"name", *_SHARED}
    }
    scenarios = tuple(getattr(campaign.model, "scenarios", ()))
    others = (*scenarios, FAILED_SHARE.name) if campaign.uncertainty is not None else scenarios
    objectives = _plain(campaign.objectives, "objectives", others)
    update |= {
        "name": campaign.name[: LONGEST_NAME - len(SUFFIX)] + SUFFIX,
        "objectives": objectives,
        "constraints": _plain(campaign.constraints, "constraints", others),
        "reference_point": {name: value for name, value in campaign.reference_point.items() if name in objectives},
    }
    if scenarios:
        update["model"] = campaign.model.model_copy(update={"scenarios": {}})
    return campaign.model_copy(update=update)


def nominal_rules(raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
    """Say why a campaign, as written, that asks for a companion has none."""
    if raw.get("nominal") is not True:
        return
    scenarios = tuple(section_of(section_of(raw, "model"), "scenarios"))
    others = scenarios if raw.get("uncertainty") is None else (*scenarios, FAILED_SHARE.name)
    objectives, constraints = section_of(raw, "objectives"), section_of(raw, "constraints")
    asked = [
        (str(name), section, entry)
        for section, entries in (("objectives", objectives), ("constraints", constraints))
        for name, entry in entries.items()
    ]
    if not any(_is_named(name, others) or _gathers(entry, section, scenarios) for name, section, entry in asked):
        sentence = (
            "no objective and no constraint is taken over scenarios or uncertainty, so the companion would be this "
            "campaign again; delete `nominal`, or give an objective its `worst_of` or `statistic`"
        )
        yield mistake(("nominal",), sentence, at_key=True)
    elif objectives and all(_is_named(str(name), others) for name in objectives):
        sentence = (
            "every objective is one named scenario's, or the samples', so nothing is left for the companion to "
            "minimise; delete `nominal`, or give an objective of the base scenario"
        )
        yield mistake(("nominal",), sentence, at_key=True)


def _plain(entries: Mapping[str, S], section: str, others: tuple[str, ...]) -> dict[str, S]:
    return {
        name: type(entry).model_construct(**{key: getattr(entry, key) for key in _PLAIN[section]})
        for name, entry in entries.items()
        if not _is_named(name, others)
    }


def _gathers(entry: object, section: str, scenarios: Sequence[str]) -> bool:
    """Whether an entry takes a quantity over more than the base scenario and the parameters as they are."""
    if not isinstance(entry, Mapping):
        return False
    over = scenarios if entry.get("worst_of") == EVERY else entry.get("worst_of") or ()
    others = (value for key, value in entry.items() if key not in {*_PLAIN[section], "worst_of"})
    return any(others) or any(scenario != BASE for scenario in over)


def _is_named(quantity: str, others: tuple[str, ...]) -> bool:
    """Whether a quantity is of a named scenario or of the samples, not of the base scenario."""
    return quantity.partition(".")[0] in others
