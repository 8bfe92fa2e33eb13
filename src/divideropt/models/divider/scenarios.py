"""Several scenarios on one design: the quantities of each, and the worst of some of them."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from divideropt.models.base import FloatArray, Outcome, Parameter, Quantity, Verdict
from divideropt.models.divider.quantities import GEOMETRIC, quantities_of
from divideropt.models.uncertain import fails_in_samples

if TYPE_CHECKING:
    from divideropt.models.divider.model import Divider

BASE = "scenario"
"""Name of the scenario whose quantities have plain names."""

AS_GOOD_AS_EQUAL = 1e-3
"""Part of a magnitude within which two scenarios are equally bad: some times what the solver's tolerance leaves."""


GATHERED = ("worst", "least")
"""What the name of a quantity begins with that is gathered over scenarios: the largest of it, the smallest."""


@dataclass(frozen=True)
class Worst:
    """The worst of one quantity over some scenarios, a quantity itself.

    Attributes:
        quantity: Its name, plain.
        scenarios: Over which of them.
        least: Whether the smallest is the worst, as for a lower bound; else the largest.
    """

    quantity: str
    scenarios: tuple[str, ...]
    least: bool = False

    @property
    def name(self) -> str:
        """Name of the quantity it makes, `worst.settling_time` or `least.stability_margin`."""
        return f"{GATHERED[self.least]}.{self.quantity}"


@dataclass(frozen=True)
class Scenarios:
    """The divider under several scenarios, as a model to optimise.

    Attributes:
        models: The divider under each by name; that of `BASE` first.
        worst: What is to be gathered over them.
        changes: Parameters that a scenario sets whatever the design says, SI, by its name and theirs.
    """

    models: Mapping[str, "Divider"]
    worst: tuple[Worst, ...] = ()
    changes: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    @property
    def base(self) -> "Divider":
        """The divider under the scenario whose quantities have plain names."""
        return self.models[BASE]

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Every parameter, in the order of a design's columns."""
        return self.base.parameters

    @cached_property
    def quantities(self) -> Mapping[str, Quantity]:
        """Every quantity: of `BASE`, of each other scenario with its name in front, and the worst of some."""
        known = quantities_by_scenario({name: model.scenario.measured_events for name, model in self.models.items()})
        return {**known, **{w.name: _quantity_of(w, known) for w in self.worst}}

    def evaluate(self, designs: FloatArray) -> tuple[FloatArray, Sequence[Verdict]]:
        """Simulate a batch under every scenario.

        Args:
            designs: Shape (n, d), columns as in `parameters`, SI.

        Returns:
            The quantities, shape (n, m), and a verdict a design: of the first scenario that does not end ok.
        """
        quantities = self.quantities
        columns: dict[str, FloatArray] = {}
        verdicts: list[Verdict] = []
        for name, model in self.models.items():
            values, found = model.evaluate(self._under(name, designs))
            columns |= {column_of(name, key): values[:, i] for i, key in enumerate(model.quantities)}
            verdicts = (
                [*found] if name == BASE else [_first(a, b, name) for a, b in zip(verdicts, found, strict=True)]
            )
        for worst in self.worst:
            over = np.array([columns[column_of(name, worst.quantity)] for name in worst.scenarios])
            columns[worst.name] = _worst_of(over, quantities[worst.name].signed, worst.least)
        return np.column_stack([columns[name] for name in quantities]), verdicts

    def _under(self, name: str, designs: FloatArray) -> FloatArray:
        """Return designs as a scenario has them, shape (n, d)."""
        changes = self.changes.get(name)
        if not changes:
            return designs
        order, changed = list(self.parameters), designs.copy()
        changed[:, [order.index(parameter) for parameter in changes]] = list(changes.values())
        return changed

    def on_threads(self, threads: int) -> "Scenarios | None":
        """Return the same model, its batches shared by threads; None where one of the scenarios' cannot be."""
        models = {name: model.on_threads(threads) for name, model in self.models.items()}
        shared = {name: model for name, model in models.items() if model is not None}
        return replace(self, models=shared) if len(shared) == len(models) else None

    def reference(self) -> "Scenarios":
        """Return the same model with the reference solver."""
        return replace(self, models={name: model.reference() for name, model in self.models.items()})


def quantities_by_scenario(events: Mapping[str, Sequence[int]]) -> dict[str, Quantity]:
    """Return every quantity under some scenarios.

    Args:
        events: Which earlier events of each have metrics, by its name; that of `BASE` first.

    Returns:
        By name: `settling_time`, `event_1.settling_time`, `cold_oil.settling_time`, `cold_oil.event_1.settling_time`.
    """
    return {q.name: q for name, numbers in events.items() for q in _of_scenario(name, numbers)}


def column_of(scenario: str, quantity: str) -> str:
    """Name a scenario's quantity: `settling_time`, or `cold_oil.settling_time`."""
    return quantity if scenario == BASE else f"{scenario}.{quantity}"


def outcomes_by_scenario(verdict: Verdict, scenarios: Sequence[str]) -> tuple[Outcome | None, ...]:
    """Return what a verdict on all scenarios, in their order, says of each.

    Returns:
        Ok for those before the one that failed, and None for those after it, of which nothing is known. What did not
        come from one scenario's simulation, a crash say, is the outcome of all. A design that fails in samples of
        uncertain parameters only is ok in every scenario as it is.
    """
    if verdict.ok or fails_in_samples(verdict):
        return (Outcome.OK,) * len(scenarios)
    if verdict.outcome in (Outcome.CRASHED, Outcome.TIMED_OUT):
        return (verdict.outcome,) * len(scenarios)
    place = scenarios.index(failed_scenario(verdict) or BASE)
    before: tuple[Outcome | None, ...] = (Outcome.OK,) * place
    return (*before, verdict.outcome, *(None,) * (len(scenarios) - place - 1))


def failed_scenario(verdict: Verdict) -> str | None:
    """Return the scenario in which a design, or a sample of it, failed first; None for that of `BASE`."""
    named = _NAMED.search(verdict.text)
    return named[1] if named else None


def _of_scenario(name: str, events: Sequence[int]) -> Iterator[Quantity]:
    for q in quantities_of(events).values():
        if name == BASE:
            yield q
        elif q.name not in GEOMETRIC:
            yield replace(q, name=f"{name}.{q.name}", description=f"{q.description}; scenario {name}")


def _quantity_of(worst: Worst, known: Mapping[str, Quantity]) -> Quantity:
    q = known[worst.quantity]
    words = f"{'smallest' if worst.least else 'largest'} over {', '.join(worst.scenarios)}"
    return replace(q, name=worst.name, description=f"{q.description}; {words}")


def _first(earlier: Verdict, later: Verdict, name: str) -> Verdict:
    """The earlier verdict unless it is ok and the later, of a named scenario, is not."""
    if not earlier.ok or later.ok:
        return earlier
    return Verdict(later.outcome, f"in scenario {name}: {later.text}")


_NAMED = re.compile(r"(?:^|samples: )in scenario ([a-z][a-z0-9_]*): ", re.ASCII)
"""How the text of a verdict names the scenario, where there are samples after their share."""


def _worst_of(over: FloatArray, signed: bool, least: bool) -> FloatArray:
    """Gather the worst of each design, NaN where one is; a signed quantity counts by magnitude and keeps its sign.

    Of scenarios that are as good as equal in magnitude the first gives the sign: mirrored ones, as of a step in
    either load, are equal but for what the solver rounds, and their sign would be a matter of chance.

    Args:
        over: Shape (scenarios, n).
        signed: Whether magnitudes are compared.
        least: Whether the smallest is sought.

    Returns:
        Shape (n,).
    """
    size = np.abs(over) if signed else over
    lost = np.isnan(size).any(axis=0)
    size = np.where(lost, 0.0, size)
    worst = size.min(axis=0) if least else size.max(axis=0)
    if signed:
        first = (np.abs(size - worst) <= AS_GOOD_AS_EQUAL * worst).argmax(axis=0)
        worst = np.copysign(worst, np.take_along_axis(over, first[None], axis=0)[0])
    return np.where(lost, np.nan, worst)
