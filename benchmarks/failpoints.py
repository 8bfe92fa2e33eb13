"""Dies once at every step of every write of a store, goes on each time, and compares with what was never stopped.

    python benchmarks/failpoints.py [--every N]

A step is a call that changes the disk: a file written (once none of it, once half), forced, linked, renamed,
removed, a folder made. A process dies in it by os._exit, as at a kill -9; then pandas reads what is there, and the
same command goes on. Three commands are stopped so: a run from nothing, one that extends a store, a verification.
"""

import argparse
import os
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any
from unittest import mock

import pandas as pd

from divideropt.campaign import batches
from divideropt.cli import commands
from divideropt.store import parts

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))  # the model that costs nothing

DIED = 99

CAMPAIGN = """
name: toy
model: {kind: "toy_model:CheckedToy"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2, weight: 2}}
constraints: {spare: {min: 0 m}}
reference_point: {f1: 1, f2: 20}
strategies:
  nsga2: {population: 12, generations: GENERATIONS, seeds: [1]}
  complex: {points: 6, evaluations: 40, seeds: [1]}
verification: {sample: 3}
optimality: {points: 3}
parallel: {workers: 1, backend: sequential}
"""


@dataclass(frozen=True)
class Scenario:
    """A command, and the store it finds; None where it finds none."""

    name: str
    command: tuple[str, ...]
    found: Path | None


class Steps:
    """Counts the calls that change the disk, and dies in one of them."""

    def __init__(self, deadly: int) -> None:
        """Patch them; `deadly` counts from 0."""
        self.names: list[str] = []
        self._deadly = deadly
        for name in ("fsync", "link", "rename", "replace", "mkdir", "unlink", "rmdir"):
            setattr(os, name, self._counted(name, getattr(os, name)))
        for name in ("write_bytes", "write_text"):
            setattr(Path, name, self._written(name, getattr(Path, name)))

    def _counted(self, name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def counted(*arguments: Any, **options: Any) -> Any:
            self._step(name, arguments[0])
            return call(*arguments, **options)

        return counted

    def _written(self, name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def written(path: Path, content: Any, **options: Any) -> Any:
            self._step(name, path)
            self._step("half of it", path, lambda: call(path, content[: len(content) // 2], **options))
            return call(path, content, **options)

        return written

    def _step(self, name: str, path: Any, last_deed: Callable[[], object] = lambda: None) -> None:
        if ".running" in str(path):
            return  # what a display shows, by the clock
        self.names.append(name)
        if len(self.names) > self._deadly:
            last_deed()
            os._exit(DIED)


def main() -> None:
    """Print how many deaths were recovered from, and end with 1 if not all were."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--every", type=int, default=1, help="Only every so many steps.")
    every = parser.parse_args().every
    parts.FLUSH_ROWS, parts.FLUSH_SECONDS = 20, 1e9  # several parts, none of them by the clock
    # the toy dies of no design, so its neighbours need no process of their own, which would take a second to start
    unguarded = mock.patch.object(batches, "dividers", lambda model: [model])
    with unguarded, tempfile.TemporaryDirectory() as folder:
        lost = sum(not enumerate_steps(scenario, Path(folder), every) for scenario in scenarios(Path(folder)))
        sys.exit(1 if lost else 0)


def scenarios(folder: Path) -> list[Scenario]:
    """Make the stores that commands find."""
    for name, generations in (("small", 3), ("whole", 6)):
        (folder / f"{name}.yaml").write_text(CAMPAIGN.replace("GENERATIONS", str(generations)), encoding="utf-8")
        shutil.rmtree(folder / name, ignore_errors=True)
        call(("run", str(folder / f"{name}.yaml"), "--store", str(folder / name)))
    run = ("run", str(folder / "whole.yaml"), "--store", "STORE")
    return [
        Scenario("run", run, None),
        Scenario("run, extending", run, folder / "small"),
        Scenario("verify", ("verify", "STORE"), folder / "whole"),
    ]


def enumerate_steps(scenario: Scenario, folder: Path, every: int) -> bool:
    """Die at each step, go on, and print the count; whether all were recovered from."""
    never = folder / "never-stopped"
    names = died(scenario, never, sys.maxsize)
    expected = tables(never)
    recovered = []
    taken = range(0, len(names), every)
    for step in taken:
        store = folder / "stopped"
        died(scenario, store, step)
        problems = objections(store, expected)
        call([word.replace("STORE", str(store)) for word in scenario.command])
        after = tables(store)
        problems += [f"{name} differs" for name in expected if not same(after.get(name), expected[name])]
        problems += [f"{path} is left" for path in store.rglob(".new-*")]
        recovered.append(not problems)
        if problems:
            print(f"{scenario.name}, step {step} ({names[step]}): {'; '.join(problems)}")
    kinds = ", ".join(f"{count} {name}" for name, count in Counter(names).items())
    print(f"{scenario.name}: {sum(recovered)} of {len(taken)} recovered; {len(names)} steps: {kinds}")
    return all(recovered)


def died(scenario: Scenario, store: Path, step: int) -> list[str]:
    """Run a command in a process that dies at a step; the steps' names if it does not."""
    shutil.rmtree(store, ignore_errors=True)
    if scenario.found is not None:
        shutil.copytree(scenario.found, store)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        steps = Steps(step)
        call([word.replace("STORE", str(store)) for word in scenario.command])
        os.write(writing, "\n".join(steps.names).encode())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        names = pipe.read().split("\n")
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if code != (0 if step == sys.maxsize else DIED):
        raise RuntimeError(f"the process ended with {code}")
    return names


def objections(store: Path, expected: dict[str, pd.DataFrame]) -> list[str]:
    """Say which logs, as pandas reads them after a death, are not the beginning of what they become."""
    logs = {name: table for name, table in tables(store).items() if name.startswith("log")}
    return [f"{name} begins otherwise" for name, log in logs.items() if not same(log, expected[name][: len(log)])]


def tables(store: Path) -> dict[str, pd.DataFrame]:
    """Read what a store holds, by pandas alone."""
    logs = {f"log {p.name}": p for p in sorted((store / "evaluations").glob("[!.]*"))}
    fronts = {f"front {p.stem}": p for p in sorted((store / "fronts").glob("[!.]*"))}
    folders = {name: store / name for name in ("fronts", "verification", "optimality") if (store / name).exists()}
    return {name: pd.read_parquet(path) for name, path in (logs | fronts | folders).items()}


def same(one: pd.DataFrame | None, other: pd.DataFrame) -> bool:
    """Whether two tables are, to the bit."""
    return one is not None and one.reset_index(drop=True).equals(other.reset_index(drop=True))


def call(command: Sequence[str]) -> None:
    """Run a command of divideropt's here, its words unheard."""
    with redirect_stderr(StringIO()):
        commands.main(list(command), standalone_mode=False)


if __name__ == "__main__":
    main()
