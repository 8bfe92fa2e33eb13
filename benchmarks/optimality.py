"""How near to stationary each strategy's own fronts are: the KKT residual's median and 95th percentile.

`python benchmarks/optimality.py STORE…` takes a random sample with a constant seed of the front of each run of the
stores, simulates the neighbours and prints a row a strategy, all runs together. The stores are of one problem; the
objectives count in the extents of all their combined fronts together, so that the rows compare.

`--points 200` is the sample a run, `--steps 1e-3 2e-3` the steps of the differences, of a variable's range.
"""

import argparse
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
import pyarrow as pa

from divideropt.analysis import Optimality, combined_front, converged, neighbours, optimality, scales_of
from divideropt.analysis.differences import STEP
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_problem, plan_runs
from divideropt.errors import DivideroptError, UsageError
from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.store import Store, TableSchema

SEED = 1
"""Of the samples."""

THREADS = 2
"""That share the simulations, where the model knows how."""


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stores", type=Path, nargs="+")
    parser.add_argument("--points", type=int, default=200, help="of each run's front")
    parser.add_argument("--steps", type=float, nargs="+", default=[STEP], help="of the differences")
    asked = parser.parse_args()
    try:
        problem, schema, fronts, together = read_fronts([Store(folder) for folder in asked.stores])
    except DivideroptError as error:
        sys.exit(f"optimality: {error}")
    scales = scales_of(combined_front(together, problem, schema), problem, schema)
    extents = zip(schema.objectives, scales, problem.objectives, strict=True)
    print("extents:", ", ".join(f"{name} {size:.4g} {o.quantity.unit}".rstrip() for name, size, o in extents))
    print(f"{'step':>7} {'strategy':<20}{'runs':>5}{'points':>8}{'median':>10}{'95 %':>10}", end="")
    print(f"{'median floor':>14}{'below floor':>13}{'not defined':>13}")
    for step in asked.steps:
        for strategy, runs in fronts.items():
            samples = [sample(front, asked.points) for front in runs if front.num_rows]
            if not samples:
                continue
            found = measure(pa.concat_tables(samples), problem, schema, scales, step)
            print(f"{step:7.0e} {strategy:<20}{len(runs):5d}{len(found):8d}{row(found)}", flush=True)


def read_fronts(stores: list[Store]) -> tuple[Problem, TableSchema, dict[str, list[pa.Table]], list[pa.Table]]:
    """Read the stores' problem, the fronts of their runs by strategy, and their combined fronts.

    Raises:
        UsageError: A store has no front yet, or is of another problem than the first.
        StoreError: A store is damaged.
    """
    first = stored_campaign(stores[0])
    problem = build_problem(first)
    schema = TableSchema.of(problem)
    runs: dict[str, list[pa.Table]] = defaultdict(list)
    together = []
    for store in stores:
        campaign = stored_campaign(store)
        for section in ("model", "variables", "objectives", "constraints"):
            if getattr(campaign, section) != getattr(first, section):
                raise UsageError(f"{store.folder}: {section} differ from those of {stores[0].folder}; compare others")
        for run in plan_runs(campaign):
            runs[run.strategy].append(_front(store, run.name, schema))
        together.append(_front(store, "combined", schema))
    return problem, schema, runs, together


def sample(front: pa.Table, count: int) -> pa.Table:
    """Draw points of a front, the same for the same front."""
    rows = np.random.default_rng(SEED).choice(front.num_rows, min(count, front.num_rows), replace=False)
    return front.take(pa.array(np.sort(rows)))


def measure(
    points: pa.Table, problem: Problem, schema: TableSchema, scales: FloatArray, step: float
) -> list[Optimality]:
    """Simulate the neighbours of points and compute their residuals."""
    simulated = problem.on_threads(THREADS) or problem
    evaluations = schema.evaluations(points)
    designs, found = evaluations.designs, []
    for design, quantities in zip(designs, evaluations.quantities, strict=True):
        around = simulated.simulate(neighbours(design, problem.space, step))
        found.append(optimality(problem, scales, design, quantities, around, step))
    return found


def row(found: list[Optimality]) -> str:
    """Word the figures of one strategy."""
    defined = [item for item in found if item.defined]
    floors = [item.floor for item in defined]
    kkt = converged([item.residual for item in defined], floors, len(found) - len(defined))
    if kkt.median is None or kkt.high is None:
        return f"{'–':>10}{'–':>10}{'–':>14}{0:13d}{kkt.not_defined:13d}"
    return f"{kkt.median:10.2e}{kkt.high:10.2e}{np.median(floors):14.1e}{kkt.below:13d}{kkt.not_defined:13d}"


def _front(store: Store, name: str, schema: TableSchema) -> pa.Table:
    front = store.read_front(name, schema)
    if front is None:
        raise UsageError(f"{store.folder}: there is no front {name} yet; run the campaign to its end first")
    return front


if __name__ == "__main__":
    main()
