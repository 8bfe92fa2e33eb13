"""Shows how far the runs are, or a count, until it is left: in place on a terminal, elsewhere a line now and then."""

import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TextIO

from rich.console import Console
from rich.live import Live
from rich.table import Table

from divideropt.campaign.standing import Standing, read_standings, time_left

SHOW_SECONDS = 0.5
"""How often a terminal is repainted."""

LINE_SECONDS = 30.0
"""How often a line is printed where the output is no terminal."""


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
        return read_standings(self._folder, self._budgets)


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
