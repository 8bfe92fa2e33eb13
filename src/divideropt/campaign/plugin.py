"""The `model` section for a model of the user's own, named `package.module:Class`."""

import importlib
import sys
from collections.abc import Mapping
from contextlib import redirect_stdout
from typing import Annotated, Any, cast

from pydantic import Field, PlainValidator

from divideropt.campaign.fields import FINITE, POSITIVE, Measure, Tables, by_name, measure_of
from divideropt.campaign.sections import Section, show
from divideropt.errors import LONGEST_WORDS, UsageError, words_of
from divideropt.models import Domain, Model, Parameter, Quantity

LONGEST_TEXT = 1000
"""Characters of a name, a unit, a symbol or a description in a model."""


def load_plugin(kind: str, options: Mapping[str, Any]) -> Model:
    """Import a model's class and make the model.

    Args:
        kind: `package.module:Class`.
        options: Keyword arguments of the class.

    Returns:
        The model.

    Raises:
        UsageError: The class cannot be imported or made, or is no model; one sentence.
    """
    module, _, name = kind.partition(":")
    if not all(part.isidentifier() for part in (*module.split("."), name)):
        raise UsageError(f"{show(kind)} names no class; write package.module:Class")
    if len(kind) > LONGEST_WORDS:
        raise UsageError(f"{show(kind)} has {len(kind)} characters, the most permitted are {LONGEST_WORDS}")
    try:
        with redirect_stdout(sys.stderr):
            made = getattr(importlib.import_module(module), name, None)
    except ImportError as error:
        raise UsageError(
            f"{show(kind)} cannot be imported ({words_of(error)}); install it, or put it on PYTHONPATH"
        ) from None
    except (Exception, SystemExit) as error:  # the module is the user's own and may fail in any way
        raise UsageError(f"importing {module} fails ({words_of(error)}); mend it first") from error
    if made is None:
        raise UsageError(f"the module {module} has no {name!r}; check the class after the colon")
    # Before anything is called: a campaign's file names the class and gives the options, and may come from anywhere.
    if not isinstance(made, type) or not callable(getattr(made, "evaluate", None)):
        raise UsageError(f"{show(kind)} is no model: it is not a class that has `evaluate`; name one that is")
    try:
        with redirect_stdout(sys.stderr):
            model = cast(Model, made(**options))
        parameters, quantities = dict(model.parameters), dict(model.quantities)
    except (Exception, SystemExit) as error:
        raise UsageError(
            f"{show(kind)} makes no model ({words_of(error)}); check `options`, and that it is a Model"
        ) from error
    for what, entries, entry in (("parameter", parameters, Parameter), ("quantity", quantities, Quantity)):
        _check_entries(kind, what, entries, entry)
    return model


def _check_entries(kind: str, what: str, entries: Mapping[Any, object], wanted: type) -> None:
    """Check that a model's names are names, and name what they should: they become columns and headings."""
    if not entries:
        raise UsageError(f"{show(kind)} has no {what}; a model has at least one")
    for name, entry in entries.items():
        if not isinstance(name, str) or not isinstance(entry, wanted) or getattr(entry, "name", None) != name:
            raise UsageError(f"{show(kind)} has a {what} {show(name)} that is not a {wanted.__name__} of that name")
        texts = (name, *(getattr(entry, field) for field in ("unit", "symbol", "description")))
        if not all(isinstance(text, str) and len(text) <= LONGEST_TEXT and text.isprintable() for text in texts):
            raise UsageError(
                f"{show(kind)} has a {what} {show(name)} whose name, unit, symbol or description is not one line of "
                f"at most {LONGEST_TEXT} printable characters"
            )
        if not name.strip() or name != name.strip():
            raise UsageError(f"{show(kind)} has a {what} {show(name)}; a name has a letter, and no space around it")
        if isinstance(entry, Parameter):
            _check_number(f"{show(kind)}, {what} {show(name)}", "default", entry.default, FINITE)
        elif isinstance(entry, Quantity):
            _check_number(f"{show(kind)}, {what} {show(name)}", "scale", entry.scale, POSITIVE)


def _check_number(which: str, attribute: str, number: object, domain: Domain) -> None:
    """Check a number that a parameter or a quantity brings along: it is computed with as those of a campaign are."""
    try:
        Measure("", domain).read(number)
    except ValueError as error:
        raise UsageError(f"{which}: its {attribute}: {error}") from None


class PluginConfig(Section):
    """A model of the user's own."""

    kind: str
    """`package.module:Class`; `divideropt.models.Model` says what the class offers."""
    options: dict[str, Any] = Field(default_factory=dict)
    """Keyword arguments of the class."""
    deadline: Annotated[float, Measure("s", POSITIVE)] | None = None
    """How long the simulation of one design may take; beyond it the design is `timed_out`. Where given, designs are
    simulated singly in a process of their own, which can be ended; where not, a model that hangs hangs its run."""
    set: Annotated[
        Mapping[str, float],
        PlainValidator(by_name("parameters", lambda parameter, raw: measure_of(parameter).read(raw))),
    ] = Field(default_factory=dict)
    """Parameters that differ from the model's defaults."""

    def make(self) -> Model:
        """Return the model."""
        return load_plugin(self.kind, self.options)

    def base_parameters(self) -> dict[str, float]:
        """Return every parameter by name, as each design has it but for the variables."""
        return {p.name: p.default for p in self.make().parameters.values()} | dict(self.set)

    def tables(self) -> Tables:
        """Return the model's parameters and quantities by name."""
        model = self.make()
        return Tables(model.parameters, model.quantities)
