"""One player on one case with one seed, kept on disk, so that a benchmark goes on where it stopped."""

import json
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from joblib import Parallel, delayed

from divideropt.problem import one_thread

from .cases import Case, case_of
from .players import Player, players
from .recorder import CEILING, Archive, Recorder, RunOverError

TELLING = 20
"""After so many runs a word is said."""

WARMING = 2
"""Designs evaluated before a run's time begins, so that nobody pays for compiling."""


@dataclass(frozen=True)
class Run:
    """What is asked for.

    Attributes:
        case: By its name.
        player: By its name.
        seed: Its seed.
        evaluations: At least so many.
        seconds: At least so many of the processor's.
    """

    case: str
    player: str
    seed: int
    evaluations: int
    seconds: float = 0.0

    def path(self, folder: Path) -> Path:
        """Return its file."""
        name = self.player.replace(" ", "_").replace("/", "")
        return folder / self.case / f"{name}-{self.seed}.parquet"


def make(runs: Sequence[Run], folder: Path, workers: int) -> int:
    """Make the runs that are not in the folder, or not long enough there, or with other settings.

    Returns:
        How many were made.
    """
    known = players()
    missing = [run for run in runs if not _sufficient(run, known[run.player], folder)]
    made = Parallel(n_jobs=workers, batch_size=1, return_as="generator_unordered")(
        delayed(_make)(run, folder) for run in missing
    )
    for count, run in enumerate(made, start=1):
        if count % TELLING == 0 or count == len(missing):
            print(f"{count} of {len(missing)} runs, {run.player} on {run.case} the last", file=sys.stderr)
    return len(missing)


def play(case: Case, player: Player, seed: int, evaluations: int, seconds: float = 0.0) -> Archive:
    """Let a player run to its end.

    Args:
        case: On what.
        player: Who.
        seed: Seeds every draw.
        evaluations: At least so many, unless the player ends earlier.
        seconds: At least so many, or `CEILING` evaluations.

    Returns:
        What was found.
    """
    if player.most is not None:
        evaluations, seconds = min(evaluations, player.most), 0.0
    with one_thread():
        case.problem.simulate(case.problem.space.sample(WARMING, np.random.default_rng(0)))
        recorder = Recorder(case.problem, evaluations, seconds)
        finished = False
        with suppress(RunOverError):
            player.play(case.problem, recorder, seed, case.span)
            finished = True
        return recorder.archive(finished)


def read(run: Run, folder: Path) -> Archive:
    """Read a run that was made."""
    table = pq.read_table(run.path(folder))
    stamps, entered, *columns = (table[name].to_numpy() for name in table.column_names)
    rows = np.flatnonzero(entered)
    F, said = np.column_stack([column[rows] for column in columns]), _said(table.schema)
    return Archive(rows + 1, stamps[rows], F, stamps, float(said["ended"]), bool(said["finished"]))


def _make(run: Run, folder: Path) -> Run:
    player, case = players()[run.player], case_of(run.case)
    _write(play(case, player, run.seed, run.evaluations, run.seconds), player.settings, run.path(folder))
    return run


def _write(archive: Archive, settings: str, path: Path) -> None:
    """Write a row an evaluation, with objectives where it entered the archive."""
    entered = np.zeros(archive.evaluations, dtype=bool)
    entered[archive.order - 1] = True
    columns: dict[str, pa.Array] = {"seconds": pa.array(archive.stamps), "entered": pa.array(entered)}
    for i, found in enumerate(archive.F.T, start=1):
        values = np.zeros(archive.evaluations)
        values[entered] = found
        columns[f"f{i}"] = pa.array(values, mask=~entered)
    said = {"settings": settings, "ended": archive.ended, "finished": archive.finished}
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(".part")
    pq.write_table(
        pa.table(columns).replace_schema_metadata({_SAID: json.dumps(said)}), unfinished, compression="zstd"
    )
    unfinished.replace(path)


def _sufficient(run: Run, player: Player, folder: Path) -> bool:
    path = run.path(folder)
    if not path.exists():
        return False
    said = _said(pq.read_schema(path))
    if said["settings"] != player.settings:
        return False
    if said["finished"]:
        return True
    count = pq.read_metadata(path).num_rows
    if player.most is not None:
        return bool(count >= min(run.evaluations, player.most))
    return bool(count >= run.evaluations and (said["ended"] >= run.seconds or count >= CEILING))


def _said(schema: pa.Schema) -> dict[str, Any]:
    return dict(json.loads(schema.metadata[_SAID]))


_SAID = b"run"
