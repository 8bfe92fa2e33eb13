"""The whole contest: our champion's runs, the time they took, everybody's runs, and what they are worth."""

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd
from joblib import Memory, Parallel, delayed

from divideropt.models.base import FloatArray

from .cases import NAMES, VALVE, case_of
from .measures import DIRECTIONS, MARKS, history, measured
from .players import PLAIN, PLAIN_EVALUATIONS, Player, players
from .runs import Run, make, read

FRESH = 2001
"""Seeds from here on are for runs after the strategies and their defaults were frozen: nothing is tried on them."""

POINTS = 28
"""Of an anytime curve."""

SPAN = 50.0
"""Its last second over its first."""

FIRST = 50
"""Evaluations at which it begins."""


@dataclass(frozen=True)
class Contest:
    """What is played, by whom, how often, how long.

    Attributes:
        folder: Where the runs are kept.
        cases: By name.
        seeds: On the valve.
        known_seeds: On each test problem.
        marks: Evaluations at which players are compared, rising.
        plain_evaluations: Of the plain strategy, on the valve: what all are measured by there.
        workers: Runs at a time.
        timed: Whether the others get as much time as the champion takes, too, and not only as many evaluations.
    """

    folder: Path
    cases: tuple[str, ...] = NAMES
    seeds: tuple[int, ...] = ()
    known_seeds: tuple[int, ...] = ()
    marks: tuple[int, ...] = MARKS
    plain_evaluations: int = PLAIN_EVALUATIONS
    workers: int = 2
    timed: bool = True

    @cached_property
    def players(self) -> dict[str, Player]:
        """Who plays, the champion first."""
        return players()

    @property
    def champion(self) -> str:
        """Our strategy that is tested against the others."""
        return next(iter(self.players))

    @property
    def first_seed(self) -> int:
        """The least seed."""
        return min(self.seeds + self.known_seeds)

    def seeds_of(self, case: str) -> tuple[int, ...]:
        """Return the seeds with which a case is played."""
        return self.seeds if case == VALVE else self.known_seeds

    def play(self) -> int:
        """Make all runs that are missing; returns how many were made."""
        first = [self._run(case, self.champion, seed) for case in self.cases for seed in self.seeds_of(case)]
        made = make(first, self.folder, self.workers)
        times = {case: self.equal_time(case) if self.timed else 0.0 for case in self.cases}
        everything = [
            self._run(case, player, seed, times[case])
            for case in self.cases
            for player in self.players
            if case == VALVE or self.players[player].everywhere
            for seed in self.seeds_of(case)
        ]
        return made + make(everything, self.folder, self.workers)

    def equal_time(self, case: str) -> float:
        """Return the champion's median time to the last mark [s], taken once and kept, since times vary."""
        asked = {"champion": self.champion, "evaluations": self.marks[-1], "seeds": list(self.seeds_of(case))}
        file = self.folder / case / f"time-{self.marks[-1]}-{self.seeds_of(case)[0]}.json"
        if file.exists():
            kept = json.loads(file.read_text("utf-8"))
            if all(kept[key] == value for key, value in asked.items()):
                return float(kept["seconds"])
        runs = [self._run(case, self.champion, seed) for seed in self.seeds_of(case)]
        seconds = float(np.median([read(run, self.folder).time_of(self.marks[-1]) for run in runs]))
        file.write_text(json.dumps({**asked, "seconds": seconds}), "utf-8")
        return seconds

    def there(self) -> list[Run]:
        """List the runs that have been made."""
        runs = (
            self._run(case, player, seed)
            for case in self.cases
            for player in self.players
            for seed in self.seeds_of(case)
        )
        return [run for run in runs if run.path(self.folder).exists()]

    def values(self) -> pd.DataFrame:
        """Measure every run: a row a number, with case, player, seed, measure, mark, value."""
        memory = Memory(self.folder / "measures", verbose=0)
        measure = memory.cache(_values)
        state = _state_of_sources()
        found = Parallel(n_jobs=self.workers)(
            delayed(measure)(
                run, self.folder, self._time_for(run), (*self.marks, self.plain_evaluations),
                state, run.path(self.folder).stat().st_mtime_ns,
            )
            for run in self.there()
        )  # fmt: skip
        return pd.DataFrame([row for rows in found for row in rows])

    def histories(self, case: str) -> tuple[FloatArray, FloatArray, dict[str, tuple[FloatArray, FloatArray]]]:
        """Return anytime curves.

        Returns:
            Evaluations, seconds, and by player the hypervolumes at these, each of shape (seeds, POINTS).
        """
        counts = np.unique(np.geomspace(FIRST, self.marks[-1], POINTS).astype(int))
        seconds = np.geomspace(self.equal_time(case) / SPAN, self.equal_time(case), POINTS)
        of: dict[str, list[tuple[FloatArray, FloatArray]]] = {}
        for run in self.there():
            if run.case == case:
                archive = read(run, self.folder)
                of.setdefault(run.player, []).append(
                    history(case_of(case), archive, counts.tolist(), seconds.tolist())
                )
        curves = {
            player: (np.array([h[0] for h in found]), np.array([h[1] for h in found])) for player, found in of.items()
        }
        return counts.astype(np.float64), seconds, curves

    def _time_for(self, run: Run) -> float:
        return self.equal_time(run.case) if self.timed and self.players[run.player].most is None else np.inf

    def _run(self, case: str, player: str, seed: int, seconds: float = 0.0) -> Run:
        plain = case == VALVE and player == PLAIN
        return Run(case, player, seed, self.plain_evaluations if plain else self.marks[-1], seconds)


def _values(
    run: Run, folder: Path, seconds: float, marks: Sequence[int], state: str, changed: int
) -> list[dict[str, object]]:
    """Measure a run; the last two arguments say which code and which file, for the cache."""
    name = {"case": run.case, "player": run.player, "seed": run.seed}
    return [{**name, **asdict(value)} for value in measured(case_of(run.case), read(run, folder), seconds, marks)]


def _state_of_sources() -> str:
    """Return a digest of all that measures: with other code or other optima, measures are taken anew."""
    return hashlib.sha256(b"".join(_sources())).hexdigest()


def _sources() -> Iterator[bytes]:
    for name in ("measures.py", "cases.py", "fronts.py", "welded_beam.csv", "recorder.py"):
        yield Path(__file__).with_name(name).read_bytes()
    if DIRECTIONS.exists():
        yield DIRECTIONS.read_bytes()
