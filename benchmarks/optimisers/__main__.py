"""Play the contest and write its tables: `python -m benchmarks.optimisers`, from the top of the repository.

The runs are kept, so that the command goes on where it stopped, and writes the tables again in seconds. With
`--quick` it takes two minutes and prints what it would write.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import moocore
import numpy as np

from divideropt.errors import DivideroptError

from . import curves, page
from .cases import NAMES, VALVE, case_of
from .contest import FRESH, Contest
from .players import players
from .runs import read

ROOT = Path(__file__).parents[2]

QUICK = Contest(
    ROOT / "results" / "benchmarks" / "optimisers-quick",
    ("ZDT1", "TNK", VALVE),
    (1, 2, 3),
    (1, 2, 3),
    (200, 1_000, 2_000),
    10_000,
)
"""What `--quick` plays, with seeds that decide nothing."""


def main() -> int:
    """Do what the command line says; returns the exit code."""
    args = _arguments()
    contest = _contest(args)
    try:
        for name in args.again:
            _forget(name, contest)
        if not args.tables:
            print(f"{contest.champion} against {len(contest.players) - 1} others", file=sys.stderr)
            print(f"{contest.play()} runs made", file=sys.stderr)
        values = contest.values()
        command = "python -m benchmarks.optimisers" + (" --quick" if args.quick else "")
        pictures: list[str] = []
        if VALVE in contest.cases and not args.no_picture:
            folder = contest.folder if args.quick else ROOT / "docs" / "benchmarks"
            drawn = list(curves.draw(contest.histories(VALVE), _best(contest), folder))
            pictures = [path.relative_to(ROOT / "docs").as_posix() if not args.quick else path.name for path in drawn]
        part = page.section(contest, values, command, pictures)
        if args.quick:
            print(part)
        else:
            page.put(part, ROOT / "docs" / "benchmarks.md")
    except DivideroptError as error:
        print(f"benchmarks.optimisers: {error}", file=sys.stderr)
        return error.exit_code
    return 0


def _contest(args: argparse.Namespace) -> Contest:
    if args.quick:
        return replace(QUICK, workers=args.workers)
    seeds = range(args.first_seed, args.first_seed + max(args.seeds, args.known_seeds))
    return Contest(
        folder=ROOT / "results" / "benchmarks" / "optimisers",
        cases=tuple(args.cases),
        seeds=tuple(seeds[: args.seeds]),
        known_seeds=tuple(seeds[: args.known_seeds]),
        workers=args.workers,
        timed=not args.untimed,
    )


def _best(contest: Contest) -> float:
    """Return the hypervolume of all archives of the valve together."""
    case = case_of(VALVE)
    fronts = [case.normalised(read(run, contest.folder).F) for run in contest.there() if run.case == VALVE]
    points = np.concatenate([front[moocore.is_nondominated(front)] for front in fronts if len(front)])
    return case.hypervolume(points)


def _forget(player: str, contest: Contest) -> None:
    """Remove a player's runs, and the times, if it is the champion."""
    for run in contest.there():
        if run.player == player:
            run.path(contest.folder).unlink()
    if player == contest.champion:
        for file in contest.folder.glob("*/time-*.json"):
            file.unlink()


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.optimisers", description=str(__doc__))
    parser.add_argument("--quick", action="store_true", help="three problems, three seeds, 2,000 evaluations")
    parser.add_argument("--seeds", type=int, default=20, help="on the valve (default: 20)")
    parser.add_argument("--known-seeds", type=int, default=10, help="on each test problem (default: 10)")
    parser.add_argument("--first-seed", type=int, default=FRESH, help=f"default: {FRESH}")
    parser.add_argument("--cases", nargs="+", choices=NAMES, default=NAMES, metavar="NAME", help=", ".join(NAMES))
    parser.add_argument("--workers", type=int, default=2, help="runs at a time (default: 2)")
    parser.add_argument(
        "--untimed", action="store_true", help="compare at equal evaluations alone: a tenth of the time"
    )
    parser.add_argument("--tables", action="store_true", help="make no runs, the tables from those that are there")
    parser.add_argument("--no-picture", action="store_true", help="do without Chromium")
    parser.add_argument(
        "--again", nargs="+", choices=players(), default=[], metavar="PLAYER", help="make these runs anew"
    )
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
