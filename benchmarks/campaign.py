"""What a campaign costs around its simulations: ratios measured in one run.

`python benchmarks/campaign.py` takes a minute or two and prints (a) the floor: the campaign's strategies on a problem
that costs nothing, NSGA-II by pymoo's own ask and tell, the others own loops; (b) the simulations: the designs of the
campaign in large batches; (c) `divideropt run` from end to end with its report, and c/(a + b). All use as many
processes as the campaign. What `run` simulates to verify points and for their KKT residuals is known beforehand in
(c); that time is printed apart.

`--scale 0.1` takes a tenth of the budgets; `--million` prints time and memory against the number of evaluations, up
to a million, and `--report` the report's time and size against the size of the front (see growth.py).
"""

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from concurrent.futures import Future, ProcessPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import growth
import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2 as PymooNSGA2  # noqa: N811
from threadpoolctl import threadpool_limits

from divideropt.campaign.load import default_text, parse_campaign
from divideropt.campaign.plan import Run, build_problem, plan_runs
from divideropt.campaign.reader import read_text
from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told
from divideropt.store import Store, TableSchema
from divideropt.strategies import NSGA2
from divideropt.strategies.ask_tell import drive

BATCH = 500
"""Designs of a large batch."""

MOST = 1.5
"""What the whole may cost, in floors and simulations."""


def main() -> None:
    """Print what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--campaign", type=Path, help="divider.yaml where not given")
    parser.add_argument("--scale", type=float, default=1.0, help="of the budgets")
    parser.add_argument("--million", action="store_true")
    parser.add_argument("--report", action="store_true")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if asked.million:
            growth.evaluations(Path(folder))
        elif asked.report:
            growth.report(Path(folder))
        else:
            text = default_text() if asked.campaign is None else asked.campaign.read_text("utf-8")
            data: Any = read_text(text, "campaign").data
            whole(json.dumps(growth.scaled(data, asked.scale)), Path(folder))


def whole(text: str, folder: Path) -> None:
    """Print floor, simulations and the whole campaign."""
    campaign = parse_campaign(text)
    runs, workers = plan_runs(campaign), campaign.parallel.workers
    (folder / "campaign.yaml").write_text(text, encoding="utf-8")
    called("simulate", "--out", folder / "response.csv")  # compiles, where that has not been done
    first = called("run", folder / "campaign.yaml", "--store", folder / "first")
    for known in ("verification", "optimality"):
        if (folder / "first" / known).is_dir():
            shutil.copytree(folder / "first" / known, folder / "second" / known)
    second = called("run", folder / "campaign.yaml", "--store", folder / "second")
    report = called("report", folder / "second")
    start = timed_start(workers)
    designs = logged(Store(folder / "second"), build_problem(campaign), runs)
    with ProcessPoolExecutor(workers) as pool:
        awaited(pool.submit(warmed, text) for _ in range(8 * workers))
        floors = timed(pool.submit(floor, text, i) for i in range(len(runs)))
        batches = np.array_split(designs, max(1, len(designs) // BATCH))
        simulations = timed(pool.submit(simulated, text, batch) for batch in batches)
    print(f"{len(designs)} evaluations in {len(runs)} runs by {workers} processes")
    print(f"(a) floor: {floors.wall:.2f} s")
    for strategy in dict.fromkeys(run.strategy for run in runs):
        each = [seconds for seconds, run in zip(floors.each, runs, strict=True) if run.strategy == strategy]
        print(f"    {strategy}, a run: {', '.join(f'{seconds:.2f}' for seconds in each)} s")
    cost = 1e6 * sum(simulations.each) / len(designs)
    print(f"(b) simulations: {simulations.wall:.2f} s, {cost:.0f} µs each on one core")
    print(f"(c) divideropt run, with its report: {second:.2f} s; divideropt report alone: {report:.2f} s")
    print(f"    verification and KKT residuals, apart: {first - second:.2f} s")
    print(f"c / (a + b) = {second / (floors.wall + simulations.wall):.2f}; wanted: at most {MOST}")
    print(f"the start of the least program with pymoo in {workers} processes: {start:.2f} s; counted in the floor, "
          f"c / (a + b) = {second / (start + floors.wall + simulations.wall):.2f}")  # fmt: skip


class Times:
    """How long tasks took, each by itself and all together."""

    def __init__(self, each: list[float], wall: float) -> None:
        """Hold the times [s]."""
        self.each, self.wall = each, wall


def timed(tasks: Iterable[Future[float]]) -> Times:
    """Wait for tasks that say how long they took."""
    begin = time.perf_counter()
    each = awaited(tasks)
    return Times(each, time.perf_counter() - begin)


def awaited(tasks: Iterable[Future[float]]) -> list[float]:
    """Submit all, then wait for all."""
    return [task.result() for task in list(tasks)]


def timed_start(workers: int) -> float:
    """How long a program takes that does next to nothing with pymoo in so many processes [s]."""
    begin = time.perf_counter()
    program = [sys.executable, str(Path(__file__).with_name("bare_pymoo.py")), str(workers)]
    subprocess.run(program, capture_output=True, check=True)
    return time.perf_counter() - begin


def called(*arguments: object) -> float:
    """Run the command in a process of its own; how long it took [s]."""
    begin = time.perf_counter()
    command = growth.command(*arguments)
    done = subprocess.run(command, env=growth.environment(), capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)} ends with {done.returncode}:\n{done.stderr}")
    return time.perf_counter() - begin


def logged(store: Store, problem: Problem, runs: Iterable[Run]) -> FloatArray:
    """All designs of a store, in the order of their runs."""
    schema = TableSchema.of(problem)
    parts = [schema.evaluations(part).designs for run in runs for part in store.log(run.name, schema).read()]
    return np.concatenate(parts)


@cache
def prepared(text: str) -> tuple[Problem, tuple[Run, ...]]:
    """The problem and the runs of a campaign, once a process."""
    campaign = parse_campaign(text)
    return build_problem(campaign), plan_runs(campaign)


def warmed(text: str) -> float:
    """Have everything imported and compiled."""
    problem, _ = prepared(text)
    problem.simulate((problem.space.lower + problem.space.upper)[None] / 2)
    time.sleep(0.1)  # so that every process gets one of these
    return 0.0


def floor(text: str, number: int) -> float:
    """How long one run's strategy takes where designs cost nothing [s]."""
    problem, runs = prepared(text)
    run = runs[number]

    def answer(designs: FloatArray) -> Told:
        return free(problem, designs)

    def score(designs: FloatArray) -> tuple[FloatArray, FloatArray]:
        told = answer(designs)
        return told.F, told.G

    begin = time.perf_counter()
    with threadpool_limits(1):
        if isinstance(run.options, NSGA2):
            shape = (len(problem.objectives), problem.constraint_count)
            algorithm = PymooNSGA2(pop_size=run.options.population)
            drive(algorithm, problem.space, shape, score, run.options.generations, run.seed)
        else:
            run.options.run(problem, answer, run.seed)
    return time.perf_counter() - begin


def free(problem: Problem, designs: FloatArray) -> Told:
    """Squared distances to corners of the box, as many as there are objectives, a fifth of the box infeasible."""
    lower, upper = problem.space.lower, problem.space.upper
    x = (designs - lower) / (upper - lower)
    corners = np.arange(len(problem.objectives))[:, None] >> np.arange(x.shape[1]) & 1
    distances = ((x[:, None, :] - corners) ** 2).sum(axis=2)
    scales = [o.quantity.scale for o in problem.objectives]
    return Told(distances * scales, np.repeat(x[:, :1] - 0.8, problem.constraint_count, axis=1))


def simulated(text: str, designs: FloatArray) -> float:
    """How long a batch takes [s]."""
    problem, _ = prepared(text)
    begin = time.perf_counter()
    problem.simulate(designs)
    return time.perf_counter() - begin


if __name__ == "__main__":
    main()
