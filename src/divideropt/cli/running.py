"""The commands that run a campaign and look at its store: run, status, verify, report, export."""

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from divideropt.cli.output import (
    AS_JSON,
    FILE,
    WORKERS,
    check_out,
    load,
    plural,
    say,
    say_when_compiling,
    write_data,
    write_json,
)
from divideropt.cli.teaching import Taught
from divideropt.errors import NoFeasibleDesignError

if TYPE_CHECKING:
    from divideropt.analysis import Convergence, Tally
    from divideropt.campaign.status import StoreStatus
    from divideropt.store import Store

# ruff: noqa: PLC0415 (what takes time is imported where it is needed)


@click.command(
    cls=Taught,
    examples=(
        "divideropt run my.yaml",
        "divideropt run my.yaml --workers 4 --store results/second",
        "divideropt run my.yaml    # once more: goes on, or says that all is done",
        "divideropt run my.yaml --json | jq '.front'",
    ),
)
@click.argument("campaign", type=FILE)
@click.option("--store", type=FILE, help="Folder of the results; results/NAME where not given.")
@WORKERS
@click.option("--fresh", is_flag=True, help="Begin anew; an existing store is moved aside, not deleted.")
@click.option(
    "--branch", is_flag=True, help="Where this processor would not repeat a log to the bit, go on as a new run."
)
@AS_JSON
def run(campaign: Path, store: Path | None, workers: int | None, fresh: bool, branch: bool, as_json: bool) -> None:
    """Run a campaign, or go on where its store stopped; write fronts and report.

    Runs that are done are not done again, so that the same call is safe whenever it is made. The last line says where
    the report is.
    """
    asked = load(campaign)
    from divideropt.api.running import run_and_report
    from divideropt.store import Store

    folder = store or Path("results") / asked.name
    again = shlex.join(["divideropt", "run", str(campaign), *([] if store is None else ["--store", str(store)])])
    again += " --branch" if branch else ""
    try:
        done = run_and_report(asked, folder, workers, sys.stderr, again, fresh=fresh, branch=branch)
    except NoFeasibleDesignError:
        say(f"report: {Store(folder).report_path}")
        raise
    if done.nothing_new:
        runs = len(done.outcomes.logs)
        words = "1 of 1 run is" if runs == 1 else f"{runs} of {runs} runs are"
        say(f"nothing to do: {words} done; front, verification and KKT residuals are as before")
    say(f"front:  {folder / 'fronts' / 'combined.parquet'} ({plural(done.outcomes.front.points, 'design')})")
    say(_counted(done.outcomes.front))
    say(_converged(done.outcomes.kkt))
    if done.companion is not None:
        count = f"{done.companion.feasible} of {plural(done.companion.points, 'design')} of its front"
        say(f"nominal: {count} {'is' if done.companion.points == 1 else 'are'} feasible in the whole campaign")
    say(f"report: {done.report}")
    if as_json:
        write_json({"store": str(folder), "report": str(done.report), **_status_data(Store(folder))})
    done.check()


@click.command(
    cls=Taught,
    examples=("divideropt verify results/my", "divideropt verify results/my --workers 4 --json"),
)
@click.argument("store", type=FILE)
@WORKERS
@AS_JSON
def verify(store: Path, workers: int | None, as_json: bool) -> None:
    """Simulate every front point again, far more exactly, and mark the fronts."""
    import dataclasses

    from divideropt.campaign.verify import verify_store
    from divideropt.report import write_report
    from divideropt.store import Store

    say_when_compiling()
    again = shlex.join(["divideropt", "verify", str(store)])
    count = verify_store(Store(store), workers, sys.stderr, again)
    report = write_report(Store(store))
    say(_counted(count))
    say(f"report: {report}")
    if as_json:
        write_json({"store": str(store), "report": str(report), **dataclasses.asdict(count)})


@click.command(
    cls=Taught,
    examples=("divideropt status results/my", "divideropt status results/my --json | jq '.runs[].best'"),
)
@click.argument("store", type=FILE)
@AS_JSON
def status(store: Path, as_json: bool) -> None:
    """Say what a store holds, what is left to do, and the best so far."""
    from divideropt.campaign.status import read_status
    from divideropt.store import Store

    if as_json:
        write_json(_status_data(Store(store)))
        return
    found = read_status(Store(store))
    _say_damage(found)
    write_data("\n".join(_status_lines(found)) + "\n")


@click.command(
    cls=Taught,
    examples=("divideropt report results/my", "divideropt report results/my --out my.html"),
)
@click.argument("store", type=FILE)
@click.option("--out", type=FILE, help="Where to write it; report.html in the store where not given.")
def report(store: Path, out: Path | None) -> None:
    """Write the HTML report of a store again."""
    check_out(out, (".html",))
    from divideropt.report import write_report
    from divideropt.store import Store

    say_when_compiling()
    say(f"report: {write_report(Store(store), out)}")


@click.command(
    cls=Taught,
    examples=(
        "divideropt export results/my --format csv",
        "divideropt export results/my --format parquet --out tables",
    ),
)
@click.argument("store", type=FILE)
@click.option(
    "--format", "kind", type=click.Choice(["csv", "parquet"]), default="csv", show_default=True, help="Of the tables."
)
@click.option("--out", type=FILE, help="A folder that is not there yet; STORE-csv or STORE-parquet where not given.")
@AS_JSON
def export(store: Path, kind: str, out: Path | None, as_json: bool) -> None:
    """Write a store's evaluations and fronts as tables into a folder of their own.

    \b
    evaluations  every evaluation, run by run, in the order they were asked for
    fronts/NAME  the feasible non-dominated designs of each run, and of all: combined
    columns.csv  unit, symbol, role and description of each column; parquet has them in each column's metadata

    Numbers are SI, percentages in percent, and read back to the bit; what is not defined is empty. An existing folder
    is never replaced, and the new one appears with all its tables or not at all.
    """  # noqa: D301 (\b is click's)
    import dataclasses

    from divideropt.campaign.export import export_store
    from divideropt.store import Store

    done = export_store(Store(store), kind, out)
    fronts = (
        ", ".join(f"{name} {count}" for name, count in done.fronts.items()) or "none before the campaign has ended"
    )
    say(f"{plural(done.evaluations, 'evaluation')}; designs on fronts: {fronts}")
    say(f"tables: {done.folder}")
    if as_json:
        write_json({**dataclasses.asdict(done), "folder": str(done.folder)})


def _status_data(store: "Store") -> dict[str, Any]:
    """Return a store's status as plain data."""
    import dataclasses

    from divideropt.campaign.status import read_status

    found = read_status(store)
    _say_damage(found)
    return dataclasses.asdict(found)


def _say_damage(found: "StoreStatus") -> None:
    if found.damage is not None:
        say(f"{found.damage}; the numbers here are from the logs")


def _status_lines(found: "StoreStatus") -> list[str]:
    """Word a status, that of the companion after that of its campaign."""
    verified = "" if found.front is None else f", {found.verified} of them verified, {found.deviating} deviating"
    lines = [f"{found.campaign}: {_count(found.front)} on the combined front{verified}"]
    lines += [] if found.kkt is None else [_converged(found.kkt)]
    for item in found.runs:
        ended = ", ".join(f"{number} {name}" for name, number in item.outcomes.items())
        outcomes = f" ({ended})" if ended else ""
        outcomes += f", the first {item.shared} of them another run's" if item.shared else ""
        best = "" if item.best is None else f"; best max λ {item.best:.4f} ({item.best_design})"
        volume = "" if item.hypervolume is None else f"; hypervolume {item.hypervolume:.4f}"
        asked = plural(item.budget, "evaluation")
        lines.append(f"{item.run}: {item.evaluations} of {asked}{outcomes}{best}{volume}")
        if item.ending is not None:
            lines.append(f"  ended: {item.ending}")
        if item.failure is not None:
            lines.append(f"  incomplete, given up: {item.failure}")
        if not item.repeatable:
            lines.append("  not repeatable from scratch: a simulation timed out or crashed")
    if found.asks_nominal:
        lines.append(_nominal_line(found))
        lines += [] if found.nominal is None else [f"nominal: {line}" for line in _status_lines(found.nominal)]
    return lines


def _nominal_line(found: "StoreStatus") -> str:
    """Say how far the comparison with the companion is."""
    if found.beside is None:
        return "nominal: the companion's front is not there yet; `divideropt run` goes on"
    known, points, feasible = found.beside.known, found.beside.points, found.beside.feasible
    designs = plural(points, "design")
    return f"nominal: {known} of {designs} of its front simulated in the whole campaign, {feasible} feasible"


def _counted(count: "Tally") -> str:
    """Say how front points came out when they were simulated again."""
    largest = ", ".join(f"{name} {value:.1e}" for name, value in count.largest.items() if value is not None)
    words = f"verified: {count.agree} of {plural(count.points, 'front point')}, {count.deviate} deviate"
    return f"{words}; largest deviation: {largest}" if largest else words


def _converged(kkt: "Convergence") -> str:
    """Say how near to stationary front points are."""
    others = f", {kkt.not_defined} not defined" if kkt.not_defined else ""
    if kkt.median is None:
        return f"KKT residual of 0 front points{others}"
    figures = f"median {kkt.median:.2g}, 95th percentile {kkt.high:.2g}"
    return f"KKT residual of {plural(kkt.computed, 'front point')}: {figures}{others}"


def _count(number: int | None) -> str:
    return "no designs" if number is None else plural(number, "design")
