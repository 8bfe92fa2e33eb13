"""`worst_of` in objectives and constraints: what it may name, and what the model gathers for it."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic_core import InitErrorDetails

from divideropt.campaign.schemas import EVERY
from divideropt.campaign.sections import Loc, mistake, section_of, show, unknown
from divideropt.models.divider.quantities import QUANTITIES
from divideropt.models.divider.scenarios import BASE, Worst

if TYPE_CHECKING:
    from divideropt.campaign.config import Campaign


def worst_case_rules(raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
    """Say what is wrong with every `worst_of`, judged on the campaign as written."""
    model = section_of(raw, "model")
    scenarios = [BASE, *section_of(model, "scenarios")]
    given: dict[str, set[str]] = {}
    for section in ("objectives", "constraints"):
        for name, entry in section_of(raw, section).items():
            asked = entry.get("worst_of") if isinstance(entry, Mapping) else None
            asked = scenarios if asked == EVERY else asked
            if not isinstance(asked, list | tuple) or not asked or not all(isinstance(n, str) for n in asked):
                continue
            where = (section, name, "worst_of")
            if ":" in str(model.get("kind")):
                yield mistake(
                    where, "a model of your own has no scenarios to take the worst of; delete it", at_key=True
                )
                continue
            if name not in QUANTITIES:
                sentence = f"{name} has no worst case over scenarios; take a quantity with a plain name"
                yield mistake(where, sentence, at_key=True)
            yield from _scenario_rules(where, asked, scenarios)
            if given.setdefault(name, set(asked)) != set(asked):
                sentence = f"{name} is taken over other scenarios among the objectives; name the same in both"
                yield mistake(where, sentence)


def _scenario_rules(where: Loc, asked: Sequence[str], scenarios: Sequence[str]) -> Iterator[InitErrorDetails]:
    for i, scenario in enumerate(asked):
        if scenario not in scenarios:
            yield mistake((*where, i), unknown("scenario", scenario, scenarios))
        elif scenario in asked[:i]:
            yield mistake((*where, i), f"{scenario} is named a second time; delete one of the two")


def read_worst_of(value: object) -> object:
    """Take the word for every scenario as the only name of a list; raises ValueError at another word."""
    if isinstance(value, str) and value != EVERY:
        raise ValueError(f"{show(value)} is neither a list of scenarios, [a, b], nor {EVERY}; write one of the two")
    return (EVERY,) if value == EVERY else value


def named_scenarios(worst_of: tuple[str, ...], model: object) -> tuple[str, ...]:
    """Name every scenario of a `model` section where `all` stands for them; else return what is named already."""
    return (BASE, *getattr(model, "scenarios", ())) if worst_of == (EVERY,) else worst_of


def worst_cases(campaign: "Campaign") -> tuple[Worst, ...]:
    """List what a campaign's objectives and constraints need gathered, each once."""
    order = [BASE, *getattr(campaign.model, "scenarios", ())]
    found = [Worst(name, _sorted(o.worst_of, order)) for name, o in campaign.objectives.items() if o.worst_of]
    for name, c in campaign.constraints.items():
        over = _sorted(c.worst_of, order)
        found += [Worst(name, over)] if over and c.max is not None else []
        found += [Worst(name, over, least=True)] if over and c.min is not None else []
    return tuple(dict.fromkeys(found))


def gathered_name(quantity: str, scenarios: Sequence[str], *, least: bool = False) -> str:
    """Name of the quantity that stands for one under `worst_of`: itself where nothing is gathered."""
    return Worst(quantity, tuple(scenarios), least).name if scenarios else quantity


def _sorted(scenarios: Sequence[str], order: Sequence[str]) -> tuple[str, ...]:
    return tuple(sorted(scenarios, key=order.index))
