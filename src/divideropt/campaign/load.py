"""A campaign's file to a `Campaign`, with every mistake in it at once."""

from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from divideropt.campaign.config import Campaign, names_plugin
from divideropt.campaign.divider import divider_tables
from divideropt.campaign.fields import Tables
from divideropt.campaign.nominal import nominal_campaign
from divideropt.campaign.plugin import load_plugin
from divideropt.campaign.reader import MOST_MISTAKES, Document, KeyPath, read_document, read_text
from divideropt.campaign.uncertainty import with_failures
from divideropt.errors import FileMistakes, Mistake, StoreError, UsageError

if TYPE_CHECKING:
    from divideropt.store import Store


def load_campaign(path: Path | str) -> Campaign:
    """Read a campaign's file.

    Args:
        path: The file.

    Returns:
        The campaign, every default filled in, every measure in the platform's units.

    Raises:
        UsageError: The file cannot be read.
        FileMistakes: Everything wrong in the file, in the order of its lines.
    """
    return campaign_of(read_document(path))


def parse_campaign(text: str, path: str = "campaign") -> Campaign:
    """Read a campaign from its text; `path` names it in mistakes. Otherwise as `load_campaign`."""
    return campaign_of(read_text(text, path))


def stored_campaign(store: "Store") -> Campaign:
    """Read the campaign of a store, as resolved when it was made.

    Raises:
        UsageError: There is no store.
        StoreError: Its campaign is damaged.
    """
    text = store.read_campaign()
    try:
        return parse_campaign(text, str(store.campaign_path))
    except UsageError as error:
        raise StoreError(f"{error}\nThis store's campaign is damaged; restore it, or start anew (--fresh)") from error


def default_campaign() -> Campaign:
    """Return the campaign that ships with the package, for commands that need none."""
    return parse_campaign(default_text(), "divider.yaml")


def default_text() -> str:
    """Return that campaign as its commented file, to start one's own from."""
    return files("divideropt.campaign").joinpath("divider.yaml").read_text("utf-8")


def campaign_of(document: Document) -> Campaign:
    """Make a campaign of what has been read; raises as `load_campaign`."""
    found = list(document.mistakes)
    try:
        tables = with_failures(_tables(document), _is_uncertain(document.data))
    except UsageError as error:
        tables = Tables()
        found += _placed(document, ("model", "kind"), str(error))
    try:
        campaign = Campaign.model_validate(document.data, context=tables)
        found += [] if found else _objections(document, campaign)
    except ValidationError as error:
        for detail in error.errors(include_url=False):
            found += _reported(document, detail)
    if found:
        raise FileMistakes(document.path, _the_first(list(dict.fromkeys(found))))
    return campaign


def _the_first(found: list[Mistake]) -> list[Mistake]:
    """Cut a list of mistakes that nobody reads to its end, and say how many more there are."""
    if len(found) <= MOST_MISTAKES:
        return found
    found = sorted(found, key=lambda m: (m.line, m.column))
    first, last = found[:MOST_MISTAKES], found[MOST_MISTAKES]
    return [*first, Mistake(last.line, last.column, f"from here on are {len(found) - MOST_MISTAKES} mistakes more")]


def _tables(document: Document) -> Tables:
    """Return the names the campaign may use; its own model, if it names one, is imported for them."""
    data = document.data
    model: Any = data.get("model") if isinstance(data, Mapping) else None
    if not names_plugin(model):
        return divider_tables(model)
    options = model.get("options", {})
    if document.mistakes or not isinstance(options, Mapping):
        return Tables()  # nothing is imported on the word of a file that is refused anyway
    made = load_plugin(model["kind"], options)
    return Tables(made.parameters, made.quantities)


def _is_uncertain(data: object) -> bool:
    return isinstance(data, Mapping) and data.get("uncertainty") is not None


def _objections(document: Document, campaign: Campaign) -> Iterator[Mistake]:
    """Say which strategies do not suit a problem of this size, or that of the companion, which may be smaller."""
    sizes = {len(campaign.objectives): ""}
    if campaign.nominal:
        sizes.setdefault(len(nominal_campaign(campaign).objectives), "the companion's: ")
    for plan in campaign.strategies:
        for objectives, whose in sizes.items():
            objection = plan.options.objection(len(campaign.variables), objectives)
            if objection is not None:
                option, sentence = objection
                yield from _placed(document, ("strategies", plan.name, option), whose + sentence)
                break
        budget = plan.options.budget(len(campaign.variables))
        if plan.window is not None and plan.window >= budget:
            sentence = (
                f"{plan.window} is too large for a budget of {budget} evaluations, within which it would never end a "
                "run; give a smaller window, or a larger budget"
            )
            yield from _placed(document, ("strategies", plan.name, "termination", "stagnation", "window"), sentence)


def _reported(document: Document, detail: ErrorDetails) -> list[Mistake]:
    return _placed(document, detail["loc"], str(detail["ctx"]["sentence"]), at_key=detail["ctx"]["at_key"])


def _placed(document: Document, path: KeyPath, sentence: str, *, at_key: bool = False) -> list[Mistake]:
    """Put a mistake in its place; nothing where the reader has refused that place already."""
    if document.is_broken(path):
        return []
    place = document.place(path, at_key=at_key)
    return [Mistake(place.line, place.column, f"{_dotted(path)}{sentence}")]


def _dotted(path: KeyPath) -> str:
    """Write a path as `model.solver.rtol: ` or `variables.spool_radius[0]: `."""
    words = "".join(f"[{step}]" if isinstance(step, int) else f".{step[:60]}" for step in path)
    return f"{words.removeprefix('.')}: " if words else ""
