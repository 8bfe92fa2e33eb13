"""The contest's part of docs/benchmarks.md: what was played and how, the tables, the picture."""

import os
import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pandas as pd

from . import tables
from .cases import VALVE
from .contest import FRESH, Contest
from .measures import DIRECTIONS
from .recorder import CEILING

BEGIN, END = "<!-- optimisers: written by python -m benchmarks.optimisers -->", "<!-- optimisers: end -->"

PACKAGES = ("pygmo", "platypus-opt", "jmetalpy", "optuna", "pymoo", "moocore", "numpy", "scipy")


def section(contest: Contest, values: pd.DataFrame, command: str, pictures: Sequence[str]) -> str:
    """Write the part.

    Args:
        contest: What was played.
        values: Its numbers.
        command: What wrote it.
        pictures: Paths from the page, the light one first; or none.

    Returns:
        Markdown, between `BEGIN` and `END`.
    """
    parts = [BEGIN, "## Optimisers against other packages", *_preface(contest, values, command)]
    parts += ["### Players", tables.players_table(contest)]
    if VALVE in contest.cases:
        parts += ["### The valve", *_picture(pictures), *tables.valve_tables(contest, values)]
        if not DIRECTIONS.exists():
            parts.append(
                f"λ over the goal directions is not measured: `{DIRECTIONS.name}`, their optima, is missing."
            )
    if set(contest.cases) != {VALVE}:
        parts += ["### Problems with known fronts", *tables.known_tables(contest, values)]
    parts.append(END)
    return "\n\n".join(parts) + "\n"


def put(part: str, page: Path) -> None:
    """Write the part into a page, in the place of the former one, or at its end."""
    text = page.read_text("utf-8") if page.exists() else "# Benchmarks\n\n"
    before, _, rest = text.partition(BEGIN)
    after = rest.partition(END)[2].lstrip("\n")
    page.write_text(before.rstrip("\n") + "\n\n" + part + ("\n" + after if after else ""), "utf-8")


def _preface(contest: Contest, values: pd.DataFrame, command: str) -> list[str]:
    known = [name for name in contest.cases if name != VALVE]
    greatest = tables.beyond(values) * 100.0 if known else 0.0
    found = f"The greatest hypervolume that any run found there is {greatest:.3f} % of the known front's."
    return [
        HOW.format(
            command=command,
            folder=contest.folder.name,
            champion=contest.champion,
            seeds=_seeds(contest, known),
            mark=contest.marks[-1],
            ceiling=CEILING,
            found=found if known else "",
        ),
        f"{_machine()}; {_versions()}.",
    ]


HOW = """\
`{command}` makes the runs that are missing in `results/benchmarks/{folder}` and writes this section.
The champion is `{champion}`: it is tested against each other player. Seeds {seeds}.

- Every evaluation of every player is kept, and the archive of all of them is measured, not what the player
  returns; only feasible designs count.
- All are told the same objectives and constraints; peers have the objectives in parts of the known front's
  extent, on the valve in parts of the reference point. pygmo has no constraints: of an infeasible design it is
  told 10⁴ and the sum of the violations in each objective, so that Deb's rule holds by dominance alone.
- Time is the processor's, of one thread, for the player and its evaluations, without compiling: the wall's, on
  a machine with nothing else to do. Equal time is the champion's median for {mark:,} evaluations; the others
  have by then as many as they manage, {ceiling:,} at most. Players that are given fewer evaluations, since they
  are slow, are not compared at equal time.
- Objectives are normalised by the known front's ideal and nadir, with the reference point 1.1; on the valve by
  the origin and the campaign's reference point.
- The best 500 points are what is left when the point that contributes least to the hypervolume is taken away,
  again and again.
- The known fronts of TNK, OSY, Truss2D, the welded beam and DTLZ7, and the volumes of DTLZ1, 2 and 7, are
  computed in `benchmarks/optimisers/fronts.py`; the other fronts are pymoo's, densely sampled. {found}"""


def _picture(pictures: Sequence[str]) -> list[str]:
    if not pictures:
        return []
    light, dark = pictures
    words = "what each player lacks of the hypervolume, over evaluations and seconds"
    source = f'<source media="(prefers-color-scheme: dark)" srcset="{dark}">'
    return [
        f'<picture>{source}<img alt="{words}" src="{light}"></picture>',
        "What is lacking of the hypervolume of all runs' archives together: medians, bands between the quartiles.",
    ]


def _seeds(contest: Contest, known: Sequence[str]) -> str:
    on_valve = [f"{_range(contest.seeds)} on the valve"] if VALVE in contest.cases else []
    fresh = ", drawn after the strategies and their defaults were frozen" if contest.first_seed >= FRESH else ""
    return "; ".join(on_valve + ([f"{_range(contest.known_seeds)} on {', '.join(known)}"] if known else [])) + fresh


def _range(seeds: Sequence[int]) -> str:
    return f"{seeds[0]}–{seeds[-1]}" if len(seeds) > 1 else f"{seeds[0]}"


def _machine() -> str:
    return f"{os.cpu_count()} cores ({platform.machine()}), Python {platform.python_version()}"


def _versions() -> str:
    return ", ".join(f"{name} {_version(name)}" for name in PACKAGES)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "(not installed)"
