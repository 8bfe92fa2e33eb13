"""Figure 3.29: a logged run of Box's complex method on a problem of two variables, read from its store."""

import io
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
from claims.judgement import Answer, Judgement
from modelpages.chart import Dots, Line, Panel, draw

from divideropt.campaign.load import parse_campaign
from divideropt.campaign.plan import build_problem
from divideropt.campaign.runner import Runner
from divideropt.models.base import Domain, FloatArray, Outcome, Parameter, Quantity, Verdict
from divideropt.strategies.complex_moves import VARIANTS
from thesisfigures.figure import Both, Row

POINTS = 6
"""Points of the complex: more than Box's 2n = 4, so that the drawing has something to reflect."""

SEED = 1
"""Of every random draw."""

CAMPAIGN = f"""
name: figure-3-29
model: {{kind: "thesisfigures.complex_run:Bowl"}}
variables: {{x1: [-1, 1], x2: [-1, 1]}}
objectives: {{depth: {{goal: 1}}}}
reference_point: {{depth: 10}}
strategies:
  complex: {{variant: box, restart: none, points: {POINTS}, evaluations: 120, seeds: [{SEED}]}}
verification: {{sample: 0}}
parallel: {{workers: 1, backend: sequential}}
"""

RUN = f"complex-{SEED}"

DRAWN_STEPS = 6
"""Reflections in the left panel: of all of them nothing could be made out."""

LEVELS = (1.02, 1.1, 1.3, 1.7, 2.3, 3.2, 4.4)
"""Contours of the problem."""

ROUNDING = 1e-9
"""How far a trial may lie from the reflection worked out from the log."""

BOX = VARIANTS["box"]
"""The variant's options."""

FOUND, NEARLY_FOUND = 0.01, 0.05
"""The optimum is found that is missed by this part of the box; by the second in part."""


class Bowl:
    """Two variables from −1 to 1 and one quantity that is least, 1, in the centre: an oblique elliptic bowl."""

    def __init__(self) -> None:
        """Nothing to choose."""
        unit = Domain(-1.0, 1.0)
        self.parameters = {name: Parameter(name, "", name, "a coordinate", 0.0, unit) for name in ("x1", "x2")}
        self.quantities = {"depth": Quantity("depth", "", "f", "what is made small", 1.0)}

    def evaluate(self, designs: FloatArray) -> tuple[FloatArray, Sequence[Verdict]]:
        """Return the height `bowl`, shape (n, 1)."""
        return bowl(designs)[:, None], [Verdict(Outcome.OK) for _ in designs]


@dataclass(frozen=True)
class Step:
    """What one step of a run did, as its log shows it.

    Attributes:
        worst: The point removed, shape (2,).
        centroid: Of the remaining points, shape (2,).
        beyond: The worst point's reflection through the centroid, shape (2,).
        trials: What was tried instead of the worst point, shape (k, 2), the last of them accepted.
    """

    worst: FloatArray
    centroid: FloatArray
    beyond: FloatArray
    trials: FloatArray

    @property
    def inside(self) -> FloatArray:
        """The reflection, put just inside the bounds where it is beyond one (Box), shape (2,)."""
        edge = 1.0 - 2.0 * BOX.margin
        return np.clip(self.beyond, -edge, edge)

    @property
    def reflected(self) -> bool:
        """Whether the first trial is that."""
        return bool(np.abs(self.trials[0] - self.inside).max() <= ROUNDING)


def bowl(points: FloatArray) -> FloatArray:
    """Return the bowl's height at points, shape (n, 2), to shape (n,)."""
    along, across = (points[:, 0] + points[:, 1]) / np.sqrt(2), (points[:, 0] - points[:, 1]) / np.sqrt(2)
    return np.asarray(1 + along**2 + 3 * across**2)


@cache
def logged_run() -> tuple[FloatArray, FloatArray]:
    """Run the campaign in a store of its own and read its log.

    Returns:
        Designs in the order they were asked for, shape (n, 2), and what was logged of them, shape (n,).
    """
    with tempfile.TemporaryDirectory() as folder:
        store = Path(folder) / "store"
        Runner(parse_campaign(CAMPAIGN), store, 1, io.StringIO()).run()
        log = pd.concat([pd.read_parquet(part) for part in sorted((store / "evaluations" / RUN).glob("*.parquet"))])
    return log[["x1", "x2"]].to_numpy(dtype=float), log["depth"].to_numpy(dtype=float)


def steps_of(points: FloatArray, depths: FloatArray) -> list[Step]:
    """Follow a log: which point was the worst, where its reflection went, and when a trial was accepted.

    Args:
        points: Shape (n, 2); the first `POINTS` are the first complex.
        depths: Shape (n,).
    """
    alpha = BOX.reflection
    held, merits = points[:POINTS].copy(), depths[:POINTS].copy()
    steps, at = [], POINTS
    while at < len(points):
        worst = int(merits.argmax())
        limit = np.delete(merits, worst).max()
        centroid = np.delete(held, worst, axis=0).mean(axis=0)
        end = at
        while end < len(points) and depths[end] >= limit:
            end += 1
        if end == len(points):
            break
        beyond = centroid + alpha * (centroid - held[worst])
        steps.append(Step(held[worst].copy(), centroid, beyond, points[at : end + 1]))
        held[worst], merits[worst] = points[end], depths[end]
        at = end + 1
    return steps


def draw_complex(_: Both) -> str:
    """Draw the first steps with their reflections, and the whole run."""
    points, depths = logged_run()
    steps = steps_of(points, depths)
    square = (-1.0, 1.0)
    first = Dots("first complex", points[:POINTS, 0], points[:POINTS, 1], 0, hollow=True, radius=5.0)
    shown = steps[:DRAWN_STEPS]
    reflections = [_joined([(s.worst, s.trials[0]) for s in shown])]
    retreats = [_joined([(a, b) for s in shown for a, b in zip(s.trials[:-1], s.trials[1:], strict=True)])]
    centroids = np.array([s.centroid for s in shown])
    accepted = np.array([s.trials[-1] for s in shown])
    left = Panel(
        [*_contours(), Line("reflection", *reflections[0], 1, "solid", 1.4),
         Line("retreat", *retreats[0], 3, "dash", 1.4)],
        "x1", "x2", f"the first {len(shown)} steps", square, square,
        dots=[first, Dots("centroid", centroids[:, 0], centroids[:, 1], 2, radius=3.0),
              Dots("accepted", accepted[:, 0], accepted[:, 1], 1)],
    )  # fmt: skip
    rest = points[POINTS:]
    right = Panel(
        _contours(), "x1", "x2", f"all {len(points)} evaluations", square, square,
        dots=[first, Dots("later", rest[:, 0], rest[:, 1], 4, radius=2.5)],
    )  # fmt: skip
    return draw([left, right], "Box's complex method on a problem of two variables, from the log of a run")


def judge_complex(_: Both) -> list[Row]:
    """Judge what the caption says."""
    points, depths = logged_run()
    return [
        Row(
            "",
            "The initial population is randomly distributed in the parameter space",
            "Yes if the first complex in the log is what the seed's generator draws evenly from the box.",
            {"the run": _drawn_evenly(points)},
        ),
        Row(
            "",
            "For each step, the worst point [is] reflected through the centroid of the remaining points",
            f"From the log: yes if the first trial of every step is centroid + {BOX.reflection:g} (centroid − "
            "worst), or, where that is beyond a bound, just inside it, as Box has it; in part if of half of them.",
            {"the run": _reflects(steps_of(points, depths))},
        ),
        Row(
            "",
            "to solve a two-dimensional optimization problem with the optimum located in the centre",
            f"Yes if the best design logged is within {100 * FOUND:g} % of the box from the centre in either "
            f"variable, in part within {100 * NEARLY_FOUND:g} %.",
            {"the run": _finds(points, depths)},
        ),
    ]


def what_was_run(_: Both) -> str:
    """Say which run it is."""
    points, depths = logged_run()
    steps = steps_of(points, depths)
    return (
        f"The strategy `complex`, variant `box`, {POINTS} points, seed {SEED}, without restarts, run by the "
        f"campaign's own runner on f = 1 + u² + 3 v² with u, v along the diagonals, and drawn from the store's log: "
        f"{len(points)} evaluations, {len(steps)} steps, {sum(len(s.trials) - 1 for s in steps)} retreats. Section "
        "3.5.1 adds a random part to each point, as variant `complex_rf` does; Box's method, which is drawn here, "
        "has none."
    )


def _drawn_evenly(points: FloatArray) -> Judgement:
    space = build_problem(parse_campaign(CAMPAIGN)).space
    same = np.array_equal(points[:POINTS], space.sample(POINTS, np.random.default_rng(SEED)))
    return Judgement(Answer.YES if same else Answer.NO, f"{POINTS} points, seed {SEED}")


def _reflects(steps: Sequence[Step]) -> Judgement:
    count = sum(step.reflected for step in steps)
    answer = Answer.YES if count == len(steps) else Answer.IN_PART if 2 * count >= len(steps) else Answer.NO
    put_inside = sum(bool(np.abs(step.beyond).max() > 1.0) for step in steps)
    return Judgement(answer, f"so in {count} of {len(steps)} steps, {put_inside} of them put inside a bound")


def _finds(points: FloatArray, depths: FloatArray) -> Judgement:
    off = float(np.abs(points[depths.argmin()]).max()) / 2
    answer = Answer.YES if off <= FOUND else Answer.IN_PART if off <= NEARLY_FOUND else Answer.NO
    return Judgement(answer, f"{100 * off:.2g} % of the box off after {len(points)} evaluations")


def _joined(pairs: Sequence[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    """Return stretches as one curve with gaps."""
    gap = np.full(2, np.nan)
    ends = np.array([point for a, b in pairs for point in (a, b, gap)]).reshape(-1, 2)
    return ends[:, 0], ends[:, 1]


def _contours() -> list[Line]:
    angles = np.linspace(0.0, 2 * np.pi, 73)
    lines = []
    for level in LEVELS:
        along, across = np.sqrt(level - 1) * np.cos(angles), np.sqrt((level - 1) / 3) * np.sin(angles)
        lines.append(Line("", (along + across) / np.sqrt(2), (along - across) / np.sqrt(2), 5, "solid", 0.8))
    return lines
