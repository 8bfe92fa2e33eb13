"""How a campaign's cost grows with its evaluations, and its report's with the front. Called by campaign.py."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from divideropt.campaign.load import default_text, parse_campaign
from divideropt.campaign.plan import build_problem
from divideropt.campaign.reader import read_text
from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace
from divideropt.store import Store, TableSchema

SHARES = (0.042, 0.25, 1.0)
"""Of a million evaluations; the first is divider.yaml as it is."""

FRONTS = (100, 1000, 10_000)

LIMIT = 1024.0
"""Memory that a process may have [MiB]."""

LOOK_SECONDS = 0.1
"""How often the processes are looked at; the system keeps their peaks."""


@dataclass(frozen=True)
class Cost:
    """What a command took: time [s], and the peak memory of its own process and of its largest worker [MiB]."""

    seconds: float
    parent: float
    worker: float


def evaluations(folder: Path) -> None:
    """Print time and memory of campaigns of divider.yaml's shape, on a model that costs nothing."""
    print(
        f"{'evaluations':>11} {'command':>8} {'time [s]':>9} {'µs each':>8} {'parent [MiB]':>13} {'worker [MiB]':>13}"
    )
    largest = 0.0
    for share in SHARES:
        file, store = folder / f"{share}.json", folder / f"store-{share}"
        text = json.dumps(zero_cost(share / SHARES[0]))
        file.write_text(text, encoding="utf-8")
        commands = {
            "run": ("run", file, "--store", store),
            "replay": ("run", file, "--store", store),
            "status": ("status", store),
            "report": ("report", store),
        }
        for name, arguments in commands.items():
            cost, count = measured(*arguments), logged(Store(store), text)
            largest = max(largest, cost.parent, cost.worker)
            each = 1e6 * cost.seconds / count
            numbers = f"{cost.seconds:9.1f} {each:8.1f} {cost.parent:13.0f} {cost.worker:13.0f}"
            print(f"{count:11d} {name:>8} {numbers}", flush=True)
    print(f"most memory of a process: {largest:.0f} MiB; wanted: below {LIMIT:.0f}")


def report(folder: Path) -> None:
    """Print the report's time and size against the front's size, on a model without responses."""
    for count in FRONTS:
        data = zero_cost(1.0)
        data["strategies"] = {"complex": {"evaluations": count}}
        text = json.dumps(data)
        problem, store = build_problem(parse_campaign(text)), Store(folder / str(count))
        store.write_campaign(text)
        log = store.log("complex-1", TableSchema.of(problem))
        log.append(problem.simulate(on_the_front(problem.space, count)))
        log.flush()
        cost = measured("report", store.folder)
        size = store.report_path.stat().st_size / 2**20
        print(f"{count:6d} designs on the front: report in {cost.seconds:.1f} s, {size:.1f} MiB", flush=True)


def zero_cost(factor: float) -> dict[str, Any]:
    """Write divider.yaml on a model that costs nothing, its budgets multiplied."""
    data: Any = read_text(default_text(), "divider.yaml").data
    data["model"] = {"kind": "zero_cost:ZeroCost"}
    return scaled(data, factor)


def scaled(data: dict[str, Any], factor: float) -> dict[str, Any]:
    """Multiply a campaign's budgets."""
    for options in data["strategies"].values():
        for budget in {"generations", "evaluations"} & options.keys():
            options[budget] = max(round(factor * options[budget]), 1)
    return data


def on_the_front(space: DesignSpace, count: int) -> FloatArray:
    """Draw designs of which none dominates another."""
    designs = (space.lower + space.upper) / 2 + np.zeros((count, 1))
    designs[:, :2] = space.sample(count, np.random.default_rng(1))[:, :2]
    return designs


def logged(store: Store, text: str) -> int:
    """Count a store's evaluations."""
    schema = TableSchema.of(build_problem(parse_campaign(text)))
    runs = (path.name for path in (store.folder / "evaluations").iterdir())
    return sum(part.num_rows for run in runs for part in store.log(run, schema).read())


def command(*arguments: object) -> list[str]:
    """Word a call of divideropt."""
    return [sys.executable, "-m", "divideropt", *map(str, arguments)]


def environment() -> dict[str, str]:
    """What makes the model of this folder importable."""
    paths = [str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))}


def measured(*arguments: object) -> Cost:
    """Call divideropt and look at its memory, by Linux's /proc."""
    begin = time.perf_counter()
    parent, worker = 0.0, 0.0
    with subprocess.Popen(
        command(*arguments), env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    ) as process:
        while process.poll() is None:
            parent = max(parent, peak(process.pid))
            worker = max([worker, *(peak(child) for child in descendants(process.pid))])
            time.sleep(LOOK_SECONDS)
        seconds = time.perf_counter() - begin
        if process.returncode:
            assert process.stderr is not None
            raise SystemExit(process.stderr.read().decode())
    return Cost(seconds, parent, worker)


def descendants(pid: int) -> Iterator[int]:
    """Processes that a process started, and theirs."""
    try:
        tasks = list(Path(f"/proc/{pid}/task").iterdir())
        children = [int(child) for task in tasks for child in (task / "children").read_text().split()]
    except OSError:  # it has ended
        return
    for child in children:
        yield child
        yield from descendants(child)


def peak(pid: int) -> float:
    """Most memory that a process has had [MiB]; 0 once it has ended."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0.0
    return next((float(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM")), 0.0)
