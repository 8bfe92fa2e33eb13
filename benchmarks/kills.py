"""Kills campaigns at random moments and goes on with them: what is lost, and what comes out otherwise.

    python benchmarks/kills.py [--kills 200] [--evaluations 3000] [--seed 1] [CAMPAIGN ...]

Campaigns on a model that does nothing but wait: one of each strategy, and `mixed` of all on two workers. Each is run
once to its end. Then it is begun anew, the whole process group is killed (-9) at a random moment, and it is begun
again on the same store, until it comes to its end; and so on until the kills are spent. After each kill every logged
row is compared with that of the uninterrupted run, cell by cell, and counted against what was there before; at each
end the fronts are compared too. Prints a line a campaign; leaves with 1 if anything was lost or differs.
"""

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

import numpy as np
import pandas as pd

from divideropt.models import Domain, Outcome, Parameter, Quantity, Verdict

PAUSE = 0.5e-3
"""How long a design takes [s]: kills shall land in the middle of runs."""

TEXT = """
name: kills
model: {kind: "kills:Waiting"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2, weight: 2}}
constraints: {spare: {min: 0 m}}
strategies: {STRATEGIES}
parallel: {workers: 2, backend: BACKEND}
"""

ONES = {
    "nsga2": "nsga2: {population: 50, generations: GENERATIONS}",
    "nsga3": "nsga3: {population: 50, generations: GENERATIONS, directions: 50}",
    "sms_emoa": "sms_emoa: {population: 50, generations: GENERATIONS}",
    "genetic": "genetic: {population: 50, generations: GENERATIONS}",
    "complex": "complex: {points: 6, evaluations: EVALUATIONS}",
    "goal_attainment": "goal_attainment: {directions: 10, evaluations: EVALUATIONS}",
    "memetic": "memetic: {population: 50, evaluations: EVALUATIONS}",
}

CAMPAIGNS = {name: (line, "sequential") for name, line in ONES.items()} | {
    "mixed": (", ".join(ONES.values()), "loky")
}


class Waiting:
    """Two objectives in conflict, at the price of a pause."""

    def __init__(self) -> None:
        """Name parameters and quantities."""
        unit = Domain(0.0, 1.0)
        self.parameters = {n: Parameter(n, "", n, "a number", 0.5, unit) for n in ("x1", "x2", "x3")}
        self.quantities = {
            "f1": Quantity("f1", "", "f1", "first objective", 1.0),
            "f2": Quantity("f2", "", "f2", "second objective", 1.0),
            "spare": Quantity("spare", "m", "s", "what is left", 1.0),
        }

    def evaluate(self, designs: np.ndarray) -> tuple[np.ndarray, list[Verdict]]:
        """Wait, then compute."""
        time.sleep(PAUSE * len(designs))
        x1, x2, x3 = designs.T
        f2 = (1 + x2) * (1 + (x3 - 0.3) ** 2) / (0.1 + x1)
        return np.column_stack([x1, f2, x1 - 0.1]), [Verdict(Outcome.OK)] * len(designs)


@dataclass
class Count:
    """What came of the kills of one campaign."""

    kills: int = 0
    early: int = 0
    ends: int = 0
    checked: int = 0
    lost: int = 0
    different: int = 0
    seconds: list[float] = field(default_factory=list)


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--kills", type=int, default=200, help="in all, over the campaigns")
    options.add_argument("--evaluations", type=int, default=3000, help="in each run")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument(
        "campaigns", nargs="*", metavar="CAMPAIGN", help=f"of {', '.join(CAMPAIGNS)}; all where none"
    )
    given = options.parse_args()
    random = Random(given.seed)
    campaigns = {name: CAMPAIGNS[name] for name in given.campaigns or CAMPAIGNS}
    share = np.diff(np.linspace(0, given.kills, len(campaigns) + 1).astype(int))
    total = Count()
    print(f"{'campaign':16} kills  before any log  ends  rows compared  lost  cells different")
    for (name, (strategies, backend)), kills in zip(campaigns.items(), share, strict=True):
        text = TEXT.replace("STRATEGIES", strategies).replace("BACKEND", backend)
        text = text.replace("GENERATIONS", str(given.evaluations // 50)).replace(
            "EVALUATIONS", str(given.evaluations)
        )
        with tempfile.TemporaryDirectory() as folder:
            count = killed(Path(folder), text, kills, random)
        say(name, count)
        for key in ("kills", "early", "ends", "checked", "lost", "different"):
            setattr(total, key, getattr(total, key) + getattr(count, key))
    say("all", total)
    return 1 if total.lost or total.different else 0


def say(name: str, c: Count) -> None:
    print(
        f"{name:16} {c.kills:5}  {c.early:14}  {c.ends:4}  {c.checked:13}  {c.lost:4}  {c.different:15}", flush=True
    )


def killed(folder: Path, text: str, kills: int, random: Random) -> Count:
    """Kill one campaign so many times."""
    (folder / "campaign.yaml").write_text(text, encoding="utf-8")
    began = time.monotonic()
    finish(start(folder, "whole"))
    longest = time.monotonic() - began
    whole, count, number = tables(folder / "whole"), Count(), 0
    while count.kills < kills:
        number += 1
        store, before = f"store-{number}", dict[str, pd.DataFrame]()
        while count.kills < kills and interrupted(start(folder, store), random.uniform(0.1, 0.8) * longest):
            count.kills += 1
            now = tables(folder / store)
            count.early += not now
            check(now, before, whole, count)
            before = now
        finish(start(folder, store))
        now = tables(folder / store)
        check(now, before, whole, count)
        count.ends += 1
        count.lost += sum(len(table) for name, table in whole.items() if name not in now)
        count.different += sum(whole[name].size != table.size for name, table in now.items())
    return count


def start(folder: Path, store: str) -> "subprocess.Popen[str]":
    """Begin a campaign, or go on with it, in a process group of its own."""
    command = [sys.executable, "-m", "divideropt", "run", "campaign.yaml", "--store", store]
    paths = [str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))}
    return subprocess.Popen(
        command, cwd=folder, env=environment, stderr=subprocess.PIPE, text=True, start_new_session=True
    )


def interrupted(process: "subprocess.Popen[str]", seconds: float) -> bool:
    """Kill the group after some seconds; say whether the campaign was still at work."""
    try:
        words = process.communicate(timeout=seconds)[1]
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return True
    if process.returncode != 0:
        raise SystemExit(f"the campaign ended with {process.returncode}:\n{words}")
    return False


def finish(process: "subprocess.Popen[str]") -> None:
    """Let a campaign come to its end."""
    words = process.communicate()[1]
    if process.returncode != 0:
        raise SystemExit(f"the campaign ended with {process.returncode}:\n{words}")


def tables(store: Path) -> dict[str, pd.DataFrame]:
    """Read the logs as anybody would; and the fronts once they are there."""
    begun = sorted({part.parent for part in (store / "evaluations").glob("[!.]*/part-*.parquet")})
    logs = {path.name: pd.read_parquet(path) for path in begun}
    return logs | {f"front {path.stem}": pd.read_parquet(path) for path in (store / "fronts").glob("*.parquet")}


def check(
    now: dict[str, pd.DataFrame], before: dict[str, pd.DataFrame], whole: dict[str, pd.DataFrame], count: Count
) -> None:
    """Count the rows that are gone since the last kill, and the cells that are not those of the uninterrupted run."""
    count.lost += sum(max(0, len(table) - len(now.get(name, ()))) for name, table in before.items())
    for name, table in now.items():
        expected = whole[name].iloc[: len(table)]
        same = (table.to_numpy() == expected.to_numpy()) | (table.isna().to_numpy() & expected.isna().to_numpy())
        count.different += int((~same).sum())
        count.checked += len(table)


if __name__ == "__main__":
    sys.exit(main())
