"""Sobol indices of every quantity of a study, with what was done about its failed designs."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from divideropt.analysis.blocks import Blocks, blocks_of
from divideropt.analysis.failures import Failures, failures_of, working
from divideropt.analysis.pick_freeze import Estimate, by_pairs, whole
from divideropt.analysis.treatments import Treated, Treatment, Undefined, quantity_columns, treated, worst_sides
from divideropt.problem import Evaluations, Problem

LEAST_BLOCKS = 32
"""Blocks, or pairs of working designs, below which an index is not worth a number."""

LEAST_DEFINED = 0.95
"""Part of the blocks in which a quantity must be defined throughout where the others are left out: those that are
left are no sample of the box any more."""

COLUMNS = ("quantity", "variable", "with", "kind", "value", "low", "high", "samples", "treatment", "used")
"""Columns of a table of indices."""


@dataclass(frozen=True)
class SobolStudy:
    """What a Sobol sample says.

    Attributes:
        indices: A row an index, see `COLUMNS`: `kind` S1, ST or S2, of S2 the other variable in `with`, `low` and
            `high` the 95 % interval, `samples` the blocks it is made from (fewer than all: the same sample's
            beginning), `treatment` what was done about failed designs, `used` the part of blocks or pairs that it
            rests on.
        undefined: The quantities that have none under a treatment.
        failures: Where designs failed.
        blocks: Number of blocks.
        failed_blocks: Those with a failed design.
        left_over: Designs at the end that make no whole block.
        second_order: Whether S2 was sampled.
    """

    indices: pd.DataFrame
    undefined: tuple[Undefined, ...]
    failures: Failures
    blocks: int
    failed_blocks: int
    left_over: int
    second_order: bool


def sobol_study(evaluations: Evaluations, problem: Problem) -> SobolStudy:
    """Estimate the indices of every quantity and of the outcome being ok.

    Args:
        evaluations: In the order of `SALib.sample.sobol`; an unfinished last block is left out.
        problem: What was simulated; of signed quantities the magnitude is analysed, as objectives and
            constraints have it.

    Returns:
        The indices of all blocks under every treatment, and under the first of each quantity those of N/2, N/4, …
        blocks.

    Raises:
        ValueError: The designs are no pick-freeze sample, or less than a block.
    """
    layout = blocks_of(evaluations.designs)
    blocks = len(evaluations) // layout.size
    left_over = len(evaluations) - blocks * layout.size
    evaluations = evaluations.part(0, blocks * layout.size)
    ok, sides = working(evaluations), worst_sides(problem)
    rows: list[pd.DataFrame] = []
    undefined: list[Undefined] = []
    done: set[str] = set()
    for name, values in quantity_columns(problem, evaluations.quantities, ok):
        if name in done:
            continue
        done.add(name)
        for first, item in _numbered(treated(name, values, ok, sides.get(name))):
            found = _estimate(item, layout)
            if isinstance(found, str):
                undefined.append(Undefined(name, item.treatment, found))
                continue
            rows.append(_rows(name, item.treatment, found, layout, problem.space.names, blocks))
            if first:
                rows += [
                    _rows(name, item.treatment, part, single, problem.space.names, count)
                    for count, part, single in _prefixes(item, layout, blocks)
                ]
    table = pd.concat(rows, ignore_index=True) if rows else pd.DataFrame(columns=list(COLUMNS))
    failed = int((~ok.reshape(blocks, -1).all(axis=1)).sum())
    return SobolStudy(
        table,
        tuple(undefined),
        failures_of(evaluations, problem.space),
        blocks,
        failed,
        left_over,
        layout.second_order,
    )


def _estimate(item: Treated, layout: Blocks) -> Estimate | str:
    """Estimate the indices, or say why there are none."""
    if item.constant:
        return "it is constant" if item.kept.any() else "it is defined in no design that counts"
    values, kept = item.values.reshape(-1, layout.size), item.kept.reshape(-1, layout.size)
    if item.treatment is Treatment.WORKING:
        found = by_pairs(values, kept, layout, LEAST_BLOCKS)
        return found if np.isfinite(found.values).any() else f"fewer than {LEAST_BLOCKS} pairs of designs have it"
    full = kept.all(axis=1)
    if full.sum() < LEAST_BLOCKS or full.mean() < LEAST_DEFINED:
        least = f"{LEAST_BLOCKS}" if full.mean() >= LEAST_DEFINED else f"{100 * LEAST_DEFINED:g} %"
        return f"it is defined throughout in {full.sum()} of {len(values)} blocks, less than {least}"
    if np.ptp(values[full]) == 0.0:
        return "it is constant"
    found = whole(values[full], layout)
    if not np.isfinite(found.values).any():
        return "it is constant in the designs whose variance is shared out"
    return Estimate(found.values, found.half, np.full(len(found.values), full.mean()))


def _prefixes(item: Treated, layout: Blocks, blocks: int) -> Iterator[tuple[int, Estimate, Blocks]]:
    """Estimate first-order and total indices from the beginnings of the sample, each half as long as the next.

    The beginning of a scrambled Sobol sequence is one itself. What it leaves out of a block are BA_1 … BA_d.
    """
    count, single = blocks // 2, Blocks(layout.variables, second_order=False)
    places = [*range(1 + layout.variables), layout.b]
    while count >= LEAST_BLOCKS:
        values = item.values.reshape(-1, layout.size)[:count, places].ravel()
        kept = item.kept.reshape(-1, layout.size)[:count, places].ravel()
        found = _estimate(Treated(item.treatment, values, kept), single)
        if not isinstance(found, str):
            yield count, found, single
        count //= 2


def _rows(
    name: str, treatment: Treatment, found: Estimate, layout: Blocks, variables: tuple[str, ...], blocks: int
) -> pd.DataFrame:
    keys = layout.keys
    table = pd.DataFrame(
        {
            "quantity": name,
            "variable": [variables[i] for _, i, _ in keys],
            "with": [None if j is None else variables[j] for _, _, j in keys],
            "kind": [kind for kind, _, _ in keys],
            "value": found.values,
            "low": found.values - found.half,
            "high": found.values + found.half,
            "samples": blocks,
            "treatment": str(treatment),
            "used": found.used,
        }
    ).astype({"with": object})
    known: pd.DataFrame = table[np.isfinite(table["value"])]
    return known


def _numbered(items: Iterator[Treated]) -> Iterator[tuple[bool, Treated]]:
    """Yield items with whether each is the first."""
    for i, item in enumerate(items):
        yield i == 0, item
