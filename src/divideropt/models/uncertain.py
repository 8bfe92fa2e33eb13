"""Uncertain parameters around any model: each design in samples of them too, and statistics over these."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, cast

import numpy as np
import scipy
from numpy.typing import NDArray

from divideropt.models.base import FloatArray, Model, Outcome, Parameter, Quantity, Threaded, Verdict, Verifiable
from divideropt.models.distributions import Distribution
from divideropt.models.guarded import evaluate_guarded
from divideropt.models.statistic import Statistic
from divideropt.models.viscosity import Walther

FAILED_SHARE = Quantity("failed_share", "%", "", "share of the samples of a design that fail", 1.0)

Acting = Literal["value", "offset", "factor"]

MOST_ROWS = 8192
"""Simulations of a batch held at a time, so that memory does not grow with it; a design's are never parted."""

_SMALLEST_SHARE = 2.0**-33
"""A share of 1 is kept so far from 0 and 1: a Sobol point can be 0, where a distribution may have no value."""


@dataclass(frozen=True)
class Source:
    """One parameter that is uncertain.

    Attributes:
        parameter: Its name.
        distribution: Of the parameter in its unit, of what is added to it, of what it is multiplied by, or of the
            temperature [°C] that `oil` makes a viscosity of.
        acting: Whether that is the value, or changes the design's own.
        oil: The law by which a temperature is a viscosity; None for any other distribution.
    """

    parameter: str
    distribution: Distribution
    acting: Acting = "value"
    oil: Walther | None = None

    def values(self, shares: FloatArray, own: FloatArray) -> FloatArray:
        """Return the parameter in each sample of each design.

        Args:
            shares: One a sample, between 0 and 1, shape (samples,).
            own: The designs' own values, shape (n,).

        Returns:
            Shape (n, samples).
        """
        drawn = self.distribution.quantiles(shares)
        drawn = drawn if self.oil is None else self.oil.viscosity(drawn)
        if self.acting == "value":
            return np.broadcast_to(drawn, (len(own), len(drawn)))
        return own[:, None] + drawn if self.acting == "offset" else own[:, None] * drawn


@dataclass(frozen=True)
class Uncertain:
    """A model of which some parameters are uncertain; made by `under_uncertainty`.

    All designs see the same sample, the first points of one scrambled Sobol sequence, so that designs are compared
    under the same conditions and a design's results do not depend on what it is simulated with. The model's own
    quantities are those of the design as it is.

    Attributes:
        model: What is simulated.
        sources: The uncertain parameters, in the order of the model's.
        samples: In how many samples each design is simulated, besides as it is.
        seed: Of the scrambling.
        needed: The statistics without which a design has failed: those of objectives and constraints.
        shown: Others.
    """

    model: Model
    sources: tuple[Source, ...]
    samples: int
    seed: int
    needed: tuple[Statistic, ...] = ()
    shown: tuple[Statistic, ...] = ()

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Every parameter, in the order of a design's columns."""
        return self.model.parameters

    @cached_property
    def quantities(self) -> Mapping[str, Quantity]:
        """Every quantity of the model, the statistics, and the share of samples that fail."""
        known = self.model.quantities
        gathered = {s.name: s.described(known[s.quantity]) for s in self._statistics}
        return {**known, **gathered, FAILED_SHARE.name: FAILED_SHARE}

    @cached_property
    def sample(self) -> FloatArray:
        """The sample that all designs see, one column a source, shape (samples, sources), between 0 and 1."""
        sequence = scipy.stats.qmc.Sobol(len(self.sources), rng=self.seed)
        points = sequence.random_base2((self.samples - 1).bit_length())[: self.samples]
        return np.asarray(np.clip(points, _SMALLEST_SHARE, 1.0 - _SMALLEST_SHARE))

    def evaluate(self, designs: FloatArray) -> tuple[FloatArray, Sequence[Verdict]]:
        """Simulate a batch, each design once as it is and once a sample.

        Args:
            designs: Shape (n, d), columns as in `parameters`.

        Returns:
            The quantities, shape (n, m), and a verdict a design: its own, or where that is ok and a needed statistic
            is not defined, that of the first sample that fails.
        """
        step = max(1, MOST_ROWS // (1 + self.samples))
        parts = [self._evaluate(designs[i : i + step]) for i in range(0, len(designs), step)]
        found = [np.empty((0, len(self.quantities))), *(quantities for quantities, _ in parts)]
        return np.concatenate(found), [v for _, verdicts in parts for v in verdicts]

    def on_threads(self, threads: int) -> "Uncertain | None":
        """Return the same model, its batches shared by threads; None where the model's cannot be."""
        shared = self.model.on_threads(threads) if isinstance(self.model, Threaded) else None
        return None if shared is None else replace(self, model=shared)

    def _evaluate(self, designs: FloatArray) -> tuple[FloatArray, list[Verdict]]:
        """Simulate a share of a batch that is not too large."""
        rows = self._rows(designs)
        outside = self._outside(rows)
        for design, sample in outside:
            rows[design, sample] = rows[design, 0]
        values, verdicts = evaluate_guarded(self.model, rows.reshape(-1, rows.shape[-1]))
        values = values.reshape(*rows.shape[:2], -1)
        by_design = [verdicts[i : i + 1 + self.samples] for i in range(0, len(verdicts), 1 + self.samples)]
        for (design, sample), verdict in outside.items():
            by_design[design][sample] = verdict
        failed = np.array([[not v.ok for v in found[1:]] for found in by_design], dtype=bool)
        gathered = self._gathered(values[:, 1:], failed)
        columns = [values[:, 0], *(gathered[s.name][:, None] for s in self._statistics)]
        lost = np.zeros(len(rows), dtype=bool)
        for statistic in self.needed:
            lost |= np.isnan(gathered[statistic.name])
        judged = [_judged(found, bool(gone)) for found, gone in zip(by_design, lost, strict=True)]
        return np.hstack([*columns, 100.0 * failed.sum(axis=1, keepdims=True) / self.samples]), judged

    def _rows(self, designs: FloatArray) -> FloatArray:
        """Lay out every design as it is and in each sample, shape (n, 1 + samples, d)."""
        places = {name: i for i, name in enumerate(self.parameters)}
        rows = np.repeat(designs[:, None], 1 + self.samples, axis=1)
        for shares, source in zip(self.sample.T, self.sources, strict=True):
            place = places[source.parameter]
            rows[:, 1:, place] = source.values(shares, designs[:, place])
        return rows

    def _outside(self, rows: FloatArray) -> dict[tuple[int, int], Verdict]:
        """Find what cannot be simulated, since a parameter is beyond its domain, by its place in the rows."""
        found = {}
        places = {name: i for i, name in enumerate(self.parameters)}
        for source in self.sources:
            parameter = self.parameters[source.parameter]
            column, domain = rows[:, :, places[parameter.name]], parameter.domain
            if domain.contains(float(column.min())) and domain.contains(float(column.max())):
                continue
            for i, j in np.ndindex(column.shape):
                if j > 0 and not domain.contains(float(column[i, j])):
                    would = f"{parameter.name} would be {column[i, j]:g} {parameter.unit}".rstrip()
                    found[i, j] = Verdict(Outcome.NOT_COMPLETED, f"{would}, but must be {domain}")
        return found

    def _gathered(self, values: FloatArray, failed: NDArray[np.bool_]) -> dict[str, FloatArray]:
        """Compute the statistics by name, of values in the samples, shape (n, samples, quantities)."""
        places = {name: i for i, name in enumerate(self.model.quantities)}
        gathered = {}
        for statistic in self._statistics:
            column = values[:, :, places[statistic.quantity]]
            signed = self.model.quantities[statistic.quantity].signed
            gathered[statistic.name] = statistic.of(np.abs(column) if signed else column, failed)
        return gathered

    @cached_property
    def _statistics(self) -> tuple[Statistic, ...]:
        """Every statistic once by its name, a needed one rather than one that is shown."""
        return tuple({s.name: s for s in (*self.shown, *self.needed)}.values())


class VerifiableUncertain(Uncertain):
    """One of a model that has a reference."""

    def reference(self) -> Uncertain:
        """Return the same uncertainty around the model's reference."""
        return replace(self, model=cast(Verifiable, self.model).reference())


def under_uncertainty(
    model: Model,
    sources: Sequence[Source],
    samples: int,
    seed: int,
    needed: Sequence[Statistic] = (),
    shown: Sequence[Statistic] = (),
) -> Uncertain:
    """Make a model of which some parameters are uncertain; it offers a reference where the model does.

    Args:
        model: What is simulated.
        sources: The uncertain parameters, each once, in any order.
        samples: In how many samples each design is simulated, at least 2.
        seed: Of the sample.
        needed: The statistics without which a design has failed.
        shown: Others.
    """
    order = list(model.parameters)
    made = VerifiableUncertain if isinstance(model, Verifiable) else Uncertain
    ranked = tuple(sorted(sources, key=lambda source: order.index(source.parameter)))
    return made(model, ranked, samples, seed, tuple(needed), tuple(shown))


def fails_in_samples(verdict: Verdict) -> bool:
    """Whether a design fails in samples of uncertain parameters only, and not as it is."""
    return _SAMPLED.match(verdict.text) is not None


_SAMPLED = re.compile(r"in [0-9]+ of [0-9]+ samples: ", re.ASCII)
"""How `_judged` says so."""


def _judged(found: Sequence[Verdict], lost: bool) -> Verdict:
    """Judge a design by itself and, where a needed statistic is lost, by the first sample that fails."""
    own, *samples = found
    failing = [verdict for verdict in samples if not verdict.ok]
    if not own.ok or not lost or not failing:
        return own
    return Verdict(failing[0].outcome, f"in {len(failing)} of {len(samples)} samples: {failing[0].text}")
