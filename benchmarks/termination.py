"""What it costs to look whether the hypervolume still grows, and where runs of `divider.yaml` would end by it.

    python benchmarks/termination.py

First, the valve: for some rules, after how many of 12,500 evaluations of NSGA-II a run ends, and what part of the
hypervolume of all of them it then has. Then, points of no cost of which the latest batches dominate few of those
before: seconds that a window of 2,000 takes over 25,000 evaluations.
"""

import time

import numpy as np

from divideropt.analysis import hypervolume_history
from divideropt.campaign.ending import Watch
from divideropt.campaign.load import default_campaign
from divideropt.campaign.plan import Run, build_problem, plan_runs, reference_of
from divideropt.campaign.termination import TerminationConfig
from divideropt.models.base import FloatArray, Quantity
from divideropt.problem import Objective, Problem, Told

SEEDS = range(1, 6)
RULES = [(1000, 1.0), (1000, 0.1), (2000, 0.1), (2000, 0.03), (4000, 0.1)]
"""Windows [evaluations] and gains [%]."""

COUNT, BATCH = 25_000, 100


def main() -> None:
    """Print both tables."""
    campaign = default_campaign()
    problem, reference, run = build_problem(campaign), reference_of(campaign), plan_runs(campaign)[0]
    assert reference is not None
    runs = [told_of(run, problem, seed) for seed in SEEDS]
    print(
        "window  gain [%]  ends after (median, least, most)  share of the hypervolume [%] (median, least)  time [s]"
    )
    for window, gain in RULES:
        ends, shares, seconds = [], [], []
        for batches in runs:
            began = time.perf_counter()
            end = end_of(run, problem, reference, batches, window, gain)
            seconds.append(time.perf_counter() - began)
            ends.append(end)
            whole = Told(np.concatenate([b.F for b in batches]), np.concatenate([b.G for b in batches]))
            before, after = hypervolume_history(whole, reference, [end, len(whole.F)])
            shares.append(100 * before / after)
        numbers = f"{np.median(ends):12.0f} {min(ends):7d} {max(ends):7d}"
        print(f"{window:6d} {gain:9g} {numbers} {np.median(shares):27.2f} {min(shares):9.2f} {max(seconds):22.2f}")
    print(f"\nobjectives  seconds over {COUNT} evaluations")
    for objectives in (2, 3):
        print(f"{objectives:10d} {of_no_cost(run, problem, objectives):8.1f}", flush=True)


def told_of(run: Run, problem: Problem, seed: int) -> list[Told]:
    """What a run is told, batch by batch."""
    batches = []

    def evaluate(designs: FloatArray) -> Told:
        batches.append(problem.tell(problem.simulate(designs)))
        return batches[-1]

    run.options.run(problem, evaluate, seed)
    return batches


def end_of(run: Run, problem: Problem, reference: FloatArray, batches: list[Told], window: int, gain: float) -> int:
    """After how many evaluations the rule ends the run; all where it does not."""
    one = Watch(ruled(run, window, gain), problem, reference)
    for batch in batches:
        ended = one.hear(batch)
        if ended is not None:
            return ended.evaluations
    return sum(len(batch.F) for batch in batches)


def of_no_cost(run: Run, problem: Problem, objectives: int) -> float:
    """Seconds for points on a sphere that shrinks a little: a front that grows with every batch."""
    random = np.random.default_rng(1)
    quantity = Quantity("q", "", "q", "any", 1.0)
    many = Problem(problem.model, problem.fixed, problem.space, (Objective(quantity),) * objectives)
    one = Watch(ruled(run, 2000, 1e-9), many, np.full(objectives, 2.0))
    seconds = 0.0
    for i in range(COUNT // BATCH):
        points = np.abs(random.standard_normal((BATCH, objectives)))
        points *= (2.0 - 1e-4 * i) / np.linalg.norm(points, axis=1)[:, None]
        told = Told(points, np.zeros((BATCH, 1)))
        began = time.perf_counter()
        one.hear(told)
        seconds += time.perf_counter() - began
    return seconds


def ruled(run: Run, window: int, gain: float) -> Run:
    """The run with a rule."""
    rule = {"stagnation": {"window": window, "gain": f"{gain} %"}}
    return Run(run.name, run.strategy, run.options, run.seed, run.budget, TerminationConfig.model_validate(rule))


if __name__ == "__main__":
    main()
