"""`worst_of` in objectives and constraints: what it may name, and what the model gathers for it."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic_core import InitErrorDetails

from divideropt.campaign.sections import mistake, unknown
from divideropt.models.divider.quantities import QUANTITIES
from divideropt.models.divider.scenarios import BASE, Worst

if TYPE_CHECKING:
    from divideropt.campaign.config import Campaign


def worst_case_rules(raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
    """Say what is wrong with every `worst_of`, judged on the campaign as written."""
    scenarios = [BASE, *_mapping(_mapping(raw, "model"), "scenarios")]
    given: dict[str, object] = {}
    for section in ("objectives", "constraints"):
        for name, entry in _mapping(raw, section).items():
            asked = entry.get("worst_of") if isinstance(entry, Mapping) else None
            if not isinstance(asked, list | tuple) or not asked:
                continue
            where = (section, name, "worst_of")
            if name not in QUANTITIES:
                sentence = f"{name} has no worst case over scenarios; take a quantity with a plain name"
                yield mistake(where, sentence, at_key=True)
            for i, scenario in enumerate(asked):
                if scenario not in scenarios:
                    yield mistake((*where, i), unknown("scenario", str(scenario), scenarios))
            if list(given.setdefault(name, list(asked))) != list(asked):  # type: ignore[call-overload]
                sentence = f"{name} is taken over other scenarios among the objectives; name the same in both"
                yield mistake(where, sentence)


def worst_cases(campaign: "Campaign") -> tuple[Worst, ...]:
    """List what a campaign's objectives and constraints need gathered, each once."""
    found = [Worst(name, objective.worst_of) for name, objective in campaign.objectives.items() if objective.worst_of]
    for name, constraint in campaign.constraints.items():
        if constraint.worst_of and constraint.max is not None:
            found.append(Worst(name, constraint.worst_of))
        if constraint.worst_of and constraint.min is not None:
            found.append(Worst(name, constraint.worst_of, least=True))
    return tuple(dict.fromkeys(found))


def gathered_name(quantity: str, scenarios: Sequence[str], *, least: bool = False) -> str:
    """Name of the quantity that stands for one under `worst_of`: itself where nothing is gathered."""
    return Worst(quantity, tuple(scenarios), least).name if scenarios else quantity


def _mapping(raw: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    section = raw.get(name)
    return section if isinstance(section, Mapping) else {}
