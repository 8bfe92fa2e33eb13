"""The `model` section for a model of the user's own, named `package.module:Class`."""

import importlib
import sys
from collections.abc import Mapping
from contextlib import redirect_stdout
from typing import Annotated, Any, cast

from pydantic import Field, PlainValidator

from divideropt.campaign.fields import POSITIVE, Measure, Tables, by_name, measure_of
from divideropt.campaign.sections import Section, show
from divideropt.errors import UsageError
from divideropt.models import Model


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
    try:
        with redirect_stdout(sys.stderr):
            made = getattr(importlib.import_module(module), name)
    except ImportError as error:
        raise UsageError(f"{show(kind)} cannot be imported ({error}); install it, or put it on PYTHONPATH") from None
    except AttributeError:
        raise UsageError(f"the module {module} has no {name!r}; check the class after the colon") from None
    except (Exception, SystemExit) as error:  # the module is the user's own and may fail in any way
        raise UsageError(f"importing {module} fails ({type(error).__name__}: {error}); mend it first") from error
    try:
        with redirect_stdout(sys.stderr):
            model = cast(Model, made(**options))
        Tables(dict(model.parameters), dict(model.quantities))
    except (Exception, SystemExit) as error:
        reason = f"{type(error).__name__}: {error}"
        raise UsageError(
            f"{show(kind)} makes no model ({reason}); check `options`, and that it is a Model"
        ) from error
    return model


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
