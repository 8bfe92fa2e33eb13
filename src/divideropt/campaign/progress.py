"""How far the runs are: each process says so in a small file, and the parent shows them all."""

import json
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
from rich.console import Console
from rich.live import Live
from rich.table import Table

from divideropt.analysis import best_attainment, hypervolume, nondominated
from divideropt.campaign.execute import Progress
from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told

WRITE_SECONDS = 0.5
"""How often a run says where it is, or less often, where that costs a share of its time that matters: """

WRITE_SHARE = 0.03
"""at most this."""

SHOW_SECONDS = 0.5
"""How often a terminal is repainted."""

LINE_SECONDS = 30.0
"""How often a line is printed where the output is no terminal."""


@dataclass(frozen=True)
class Standing:
    """Where a run is.

    Attributes:
        run: Its name.
        done: Evaluations answered.
        budget: Most evaluations it asks for.
        replayed: Those of them that came from the log.
        rate: Evaluations simulated a second; 0 before the first.
        best: Least max λ_i of its feasible designs; None where there is none, or no goals.
        hypervolume: Of its feasible designs, None without a reference point.
        ended: Why the run has ended; None before it has.
    """

    run: str
    done: int
    budget: int
    replayed: int
    rate: float
    best: float | None
    hypervolume: float | None
    ended: str | None

    @property
    def left(self) -> float | None:
        """How long its budget lasts at its rate [s]; None before that is known, and 0 once it has ended."""
        if self.ended is not None:
            return 0.0
        return (self.budget - self.done) / self.rate if self.rate > 0 else None


def time_left(standings: Sequence[Standing], budgets: Mapping[str, int]) -> float | None:
    """Estimate how long all runs take, should each spend its budget.

    Args:
        standings: Of the runs that have begun.
        budgets: Evaluations of every run, by name.

    Returns:
        All that is left at the rate at which the runs at work go on together, or what the slowest of them has left,
        if that is longer [s]; None before any has a rate.
    """
    working = [s for s in standings if s.ended is None]
    rate = sum(s.rate for s in working)
    begun = {s.run for s in standings}
    waiting = sum(budget for run, budget in budgets.items() if run not in begun)
    if rate <= 0.0:
        return 0.0 if not working and not waiting else None
    together = (waiting + sum(s.budget - s.done for s in working)) / rate
    return max([together, *(s.left for s in working if s.left is not None)])


class Reporter:
    """Keeps a run's standing and writes it to a file now and then."""

    def __init__(self, path: Path, run: str, budget: int, problem: Problem, reference: FloatArray | None) -> None:
        """Begin with nothing done."""
        self._path, self._run, self._budget = path, run, budget
        self._problem, self._reference = problem, reference
        self._done = self._replayed = 0
        self._best: float | None = None
        self._front = np.empty((0, len(problem.objectives)))
        self._fresh: list[Told] = []
        self._began = self._written = time.monotonic()
        self._took = 0.0

    def __call__(self, progress: Progress) -> None:
        """Hear of a batch."""
        n = len(progress.told.F)
        self._done += n
        if progress.replayed:
            self._replayed += n
            self._began = time.monotonic()
        self._fresh.append(progress.told)
        if time.monotonic() - self._written >= max(WRITE_SECONDS, self._took / WRITE_SHARE):
            self.write()
            self._took = time.monotonic() - self._written

    def write(self, ended: str | None = None) -> None:
        """Write the standing, and why the run has ended if it has; a disk that refuses does not matter here."""
        self._written = time.monotonic()
        text = json.dumps(asdict(self._standing(ended)))
        temporary = self._path.with_suffix(".new")
        try:
            temporary.write_text(text, encoding="utf-8")
            temporary.replace(self._path)
        except OSError:
            return

    def _standing(self, ended: str | None) -> Standing:
        if self._fresh:
            told = Told(*(np.concatenate(parts) for parts in zip(*((t.F, t.G) for t in self._fresh), strict=True)))
            self._fresh = []
            best = best_attainment(told, self._problem)
            if best is not None and (self._best is None or best[1] < self._best):
                self._best = best[1]
            front = np.concatenate([self._front, told.F[told.feasible]])
            self._front = front[nondominated(front)]
        elapsed = time.monotonic() - self._began
        fresh = self._done - self._replayed
        volume = None if self._reference is None else hypervolume(self._front, self._reference)
        rate = fresh / elapsed if elapsed > 0 else 0.0
        return Standing(self._run, self._done, self._budget, self._replayed, rate, self._best, volume, ended)


class Display:
    """Shows the standings of all runs until it is left."""

    def __init__(self, folder: Path, budgets: Mapping[str, int], stream: TextIO) -> None:
        """Show the files of `folder` for these runs on `stream`, in place if that is a terminal."""
        self._folder, self._budgets = folder, budgets
        self._console = Console(file=stream, highlight=False)
        self._in_place = _repaints(self._console)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._show, daemon=True)

    def __enter__(self) -> "Display":
        """Begin to show."""
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        """Show the last standings and end."""
        self._over.set()
        self._thread.join()

    def say(self, words: str) -> None:
        """Print a line of its own."""
        with suppress(OSError):  # nobody to hear it
            self._console.print(words, soft_wrap=True, markup=False)

    def _show(self) -> None:
        with suppress(OSError):  # nobody to see it
            self._show_until_left()

    def _show_until_left(self) -> None:
        if self._in_place:
            with Live(self._table(), console=self._console, auto_refresh=False) as live:
                while not self._over.wait(SHOW_SECONDS):
                    live.update(self._table(), refresh=True)
                live.update(self._table(), refresh=True)
            return
        said: set[str] = set()
        while not self._over.wait(LINE_SECONDS):
            self._lines(said)
        self._lines(said)

    def _lines(self, said: set[str]) -> None:
        """Print a line for each run that has something new to say."""
        standings = self._standings()
        for standing in standings:
            if standing.run not in said:
                self._console.print(_line(standing), soft_wrap=True)
            if standing.ended is not None:
                said.add(standing.run)
        left = time_left(standings, self._budgets)
        if left:
            self._console.print(f"all runs: {_duration(left)} left at most", soft_wrap=True)

    def _table(self) -> Table:
        standings = self._standings()
        left = time_left(standings, self._budgets)
        table = Table(box=None, caption=f"all runs: {_duration(left)} left at most" if left else None)
        for heading in ("run", "evaluations", "", "rate [1/s]", "left", "best max λ", "hypervolume"):
            table.add_column(heading, justify="left" if heading == "run" else "right")
        for s in standings:
            table.add_row(
                s.run,
                f"{s.done} of {s.budget}",
                _state(s),
                f"{s.rate:.0f}",
                "" if s.ended is not None else _duration(s.left),
                _number(s.best),
                _number(s.hypervolume),
            )
        return table

    def _standings(self) -> list[Standing]:
        found = []
        for run in self._budgets:
            try:
                text = (self._folder / f"{run}.json").read_text(encoding="utf-8")
                found.append(Standing(**json.loads(text)))
            except (OSError, ValueError, TypeError):
                continue
        return found


def say(words: str, stream: TextIO) -> None:
    """Print a line, whether or not there is anybody to hear it."""
    with suppress(OSError):
        print(words, file=stream, flush=True)


class Counter:
    """Shows how far a count is until it is left: in place on a terminal, elsewhere a line now and then."""

    def __init__(self, words: str, total: int, stream: TextIO) -> None:
        """Begin at 0; `words` has a place for the count and one for the total."""
        self._words, self._total, self._count, self._width = words, total, 0, 0
        self._console = Console(file=stream, highlight=False)
        self._in_place = _repaints(self._console)
        self._seconds = SHOW_SECONDS if self._in_place else LINE_SECONDS
        self._began = self._shown = time.monotonic()

    def __enter__(self) -> "Counter":
        """Begin to show."""
        return self

    def __exit__(self, *exc: object) -> None:
        """Show the last count on a line of its own."""
        self._show("\n")

    def advance(self) -> None:
        """Count one more."""
        self._count += 1
        if time.monotonic() - self._shown >= self._seconds:
            self._show("\r" if self._in_place else "\n")

    def _show(self, end: str) -> None:
        self._shown = time.monotonic()
        with suppress(OSError):  # nobody to see it
            words = self._words.format(self._count, self._total)
            if 0 < self._count < self._total:
                each = (self._shown - self._began) / self._count
                words += f", {_duration(each * (self._total - self._count))} left"
            # in place, spaces cover what was longer
            self._console.print(f"{words:{self._width}}", end=end, soft_wrap=True)
            self._width = len(words) if self._in_place else 0


def _repaints(console: Console) -> bool:
    """Whether a line can be written over: on no dumb terminal, file or pipe, whatever FORCE_COLOR says."""
    return bool(console.file.isatty()) and not console.is_dumb_terminal


def _line(s: Standing) -> str:
    rate = f", {s.rate:.0f}/s" if s.rate > 0.0 else ""
    replayed = f", {s.replayed} from the log" if s.replayed else ""
    left = "" if not s.left else f", {_duration(s.left)} left at most"
    return (
        f"{s.run}: {s.done} of {s.budget} evaluations{replayed} ({_state(s)}){rate}{left}, "
        f"best max λ {_number(s.best)}, hypervolume {_number(s.hypervolume)}"
    )


def _state(s: Standing) -> str:
    if s.ended is None:
        return f"{100 * s.done / s.budget:.0f} %"
    return "done" if s.done == s.budget else f"done: {s.ended}"


def _duration(seconds: float | None) -> str:
    """Write a time in the two largest of its units, as nobody knows it more exactly."""
    if seconds is None:
        return "–"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes = round(whole / 60) if whole >= 600 else whole // 60
    if minutes < 60:
        return f"{minutes} min" if whole >= 600 else f"{minutes} min {whole % 60} s"
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours < 24 else f"{hours // 24} d {hours % 24} h"


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4f}"
