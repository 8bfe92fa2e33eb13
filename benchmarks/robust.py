"""How well a sample of uncertain parameters knows a percentile, and what simulations with friction cost.

    python benchmarks/robust.py

First, a design near the best of `robust.yaml`: by how much the objectives of ten samples of several sizes are off
those of a large one. Then, the processor time of a simulation by friction. docs/how-to/robust.md has what it prints.
"""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from divideropt.campaign.load import load_campaign
from divideropt.campaign.plan import build_problem
from divideropt.models.base import FloatArray
from divideropt.models.uncertain import Uncertain
from divideropt.problem import Problem

CAMPAIGN = Path(__file__).parents[1] / "campaigns" / "robust.yaml"

DESIGN = np.array([13.65e-3, 1.19e-3, 9.33e6, 0.891, 0.277])
"""The variables in the campaign's order, SI."""

SIZES, SEEDS, LARGE = (16, 32, 64, 128, 256), range(1, 11), 4096

FRICTIONS = (0.0, 0.1, 1.0, 5.0, 10.0)
"""[N]."""

SIMULATIONS = 2000
"""By which a cost is measured."""


def main() -> None:
    """Print both tables."""
    problem = build_problem(load_campaign(CAMPAIGN))
    names = [o.quantity.name for o in problem.objectives]
    large = objectives(problem, LARGE, 1)
    print(f"off {LARGE} samples, mean and standard deviation over {len(SEEDS)} seeds [%]:")
    print("samples", *(f"{name:>24}" for name in names))
    for size in SIZES:
        off = 100.0 * (np.array([objectives(problem, size, seed) for seed in SEEDS]) / large - 1.0)
        found = zip(off.mean(axis=0), off.std(axis=0, ddof=1), strict=True)
        print(f"{size:7d}", *(f"{f'{mean:+.2f} ± {spread:.2f}':>24}" for mean, spread in found))
    anywhere = problem.space.sample(SIMULATIONS, np.random.default_rng(0))
    print("\nprocessor time of a simulation [µs]:\nfriction [N]  that design  designs anywhere in the box")
    for friction in FRICTIONS:
        best, box = (microseconds(problem, friction, X) for X in (np.tile(DESIGN, (SIMULATIONS, 1)), anywhere))
        print(f"{friction:12g} {best:12.0f} {box:28.0f}", flush=True)


def objectives(problem: Problem, samples: int, seed: int) -> FloatArray:
    """The objectives of the design in another sample, shape (k,)."""
    other = replace(problem, model=replace(model_of(problem), samples=samples, seed=seed))
    return np.asarray(other.tell(other.simulate(DESIGN[None])).F[0])


def microseconds(problem: Problem, friction: float, designs: FloatArray) -> float:
    """Processor time of one simulation of designs as they are, with that friction [N]."""
    fixed = {**problem.fixed, "coulomb_friction": friction}
    plain = replace(problem, model=model_of(problem).model, fixed=fixed, objectives=(), constraints=())
    plain.simulate(designs[:2])
    began = time.process_time()
    plain.simulate(designs)
    return 1e6 * (time.process_time() - began) / len(designs)


def model_of(problem: Problem) -> Uncertain:
    """The campaign's model with its uncertainty."""
    assert isinstance(problem.model, Uncertain)
    return problem.model


if __name__ == "__main__":
    main()
