"""The command line: parse, call, exit code. Data goes to standard output, words to standard error."""

import os
import shlex
import sys
import traceback
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from divideropt.errors import (
    DiskError,
    DivideroptError,
    FileMistakes,
    IncompleteRunsError,
    NoFeasibleDesignError,
    UsageError,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from divideropt.analysis import Convergence, Tally
    from divideropt.campaign.config import Campaign
    from divideropt.campaign.status import StoreStatus

# Everything else is imported by the command that needs it, so that --help answers at once.
# ruff: noqa: PLC0415

_FILE = click.Path(path_type=Path)
_SET = click.option(
    "--set", "settings", multiple=True, metavar="NAME=VALUE", help="A parameter, such as spool_radius='9 mm'."
)
_SCENARIO = click.option("--scenario", default="scenario", metavar="NAME", help="One of the campaign's `scenarios`.")


def main() -> None:
    """Run the command and leave with its exit code."""
    try:
        code = commands.main(standalone_mode=False) or 0
    except click.ClickException as error:
        error.show()
        code = 2
    except (click.Abort, KeyboardInterrupt):
        _say("divideropt: stopped by SIGINT; nothing that was logged is lost")
        code = 130
    except FileMistakes as error:
        _say(str(error))  # file:line:column, which editors know
        code = error.exit_code
    except DivideroptError as error:
        _say(f"divideropt: {error}")
        code = error.exit_code
    except Exception:
        traceback.print_exc()
        _say("divideropt: this is a bug in divideropt; the lines above say where. Nothing that was logged is lost.")
        code = 1
    try:
        sys.stderr.flush()
    except OSError:  # nobody to hear it, and what is in the buffer would be flushed again when Python ends
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    sys.exit(code)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="divideropt")
def commands() -> None:
    """Multiobjective optimisation of simulated hydraulic components.

    \b
    Begin with
      divideropt run campaigns/quickstart.yaml
    and open results/quickstart/report.html.
    """  # noqa: D301 (\b is click's)


@commands.command()
@click.argument("campaign", type=_FILE)
@click.option("--store", type=_FILE, help="Folder of the results; results/NAME where not given.")
@click.option("--workers", type=click.IntRange(1, 256), help="Processes at a time; the campaign's where not given.")
@click.option("--fresh", is_flag=True, help="Begin anew; an existing store is moved aside, not deleted.")
def run(campaign: Path, store: Path | None, workers: int | None, fresh: bool) -> None:
    """Run a campaign, or go on where its store stopped; write fronts and report."""
    asked = _load(campaign)
    from divideropt.campaign.companion import run_campaign
    from divideropt.report import write_report
    from divideropt.store import Store

    folder = store or Path("results") / asked.name
    again = shlex.join(["divideropt", "run", str(campaign), *([] if store is None else ["--store", str(store)])])
    try:
        done, companion = run_campaign(
            asked, folder, workers or asked.parallel.workers, sys.stderr, again, fresh=fresh
        )
    except NoFeasibleDesignError:
        _say(f"report: {write_report(Store(folder))}")
        raise
    _say(f"front:  {folder / 'fronts' / 'combined.parquet'} ({done.front.points} designs)")
    _say(_counted(done.front))
    _say(_converged(done.kkt))
    failures, runs = dict(done.failures), len(done.logs)
    if companion is not None:
        count = f"{companion.feasible} of {companion.points} designs of its front"
        _say(f"nominal: {count} are feasible in the whole campaign")
        if companion.outcomes is not None:
            failures |= {f"nominal/{name}": reason for name, reason in companion.outcomes.failures.items()}
            runs += len(companion.outcomes.logs)
    _say(f"report: {write_report(done.store, logs=done.logs)}")
    if failures:
        raise _incomplete(folder, failures, runs, again)


@commands.command()
@click.argument("store", type=_FILE)
@click.option("--workers", type=click.IntRange(1, 256), help="Processes at a time; the campaign's where not given.")
def verify(store: Path, workers: int | None) -> None:
    """Simulate every front point again, far more exactly, and mark the fronts."""
    from divideropt.campaign.verify import verify_store
    from divideropt.report import write_report
    from divideropt.store import Store

    _say_when_compiling()
    again = shlex.join(["divideropt", "verify", str(store)])
    count = verify_store(Store(store), workers, sys.stderr, again)
    _say(f"report: {write_report(Store(store))}")
    _say(_counted(count))


@commands.command()
@click.argument("store", type=_FILE)
@click.option("--json", "as_json", is_flag=True, help="As JSON on standard output.")
def status(store: Path, as_json: bool) -> None:
    """Say what a store holds, what is left to do, and the best so far."""
    import dataclasses
    import json

    from divideropt.campaign.status import read_status
    from divideropt.store import Store

    found = read_status(Store(store))
    if found.damage is not None:
        _say(f"{found.damage}; the numbers here are from the logs")
    if as_json:
        _write_data(json.dumps(dataclasses.asdict(found), indent=2) + "\n")
        return
    _write_data("\n".join(_status_lines(found)) + "\n")


@commands.command()
@click.argument("store", type=_FILE)
@click.option("--out", type=_FILE, help="Where to write it; report.html in the store where not given.")
def report(store: Path, out: Path | None) -> None:
    """Write the HTML report of a store again."""
    _check_out(out, (".html",))
    from divideropt.report import write_report
    from divideropt.store import Store

    _say_when_compiling()
    _say(f"report: {write_report(Store(store), out)}")


@commands.command()
@click.argument("stores", type=_FILE, nargs=-1, required=True, metavar="STORE...")
@click.option("--at", "evaluations", type=click.IntRange(1), help="After so many evaluations of each run.")
@click.option("--json", "as_json", is_flag=True, help="As JSON on standard output.")
@click.option("--out", type=_FILE, help="A .csv or .parquet file for the indicators of each run.")
def compare(stores: tuple[Path, ...], evaluations: int | None, as_json: bool, out: Path | None) -> None:
    """Compare strategies over their seeds, in one store or several of one problem; then help to choose a design."""
    _check_out(out, (".csv", ".parquet"))
    import json

    from divideropt.campaign.compare import compare_stores
    from divideropt.report import comparison_data, comparison_table, comparison_text

    found = compare_stores(stores, evaluations)
    if out is not None:
        _write_table(comparison_table(found), out)
    _write_data(json.dumps(comparison_data(found), indent=2) + "\n" if as_json else comparison_text(found))
    for sentence in found.words:
        _say(sentence)


@commands.command()
@click.argument("campaign", type=_FILE)
@click.option("--method", type=click.Choice(["oat", "morris", "sobol"]), default="oat", show_default=True)
@click.option("--parameter", "parameters", multiple=True, metavar="NAME[=LOWER..UPPER]", help="Study this instead.")
@click.option(
    "--samples", type=click.IntRange(2), help="Points of a sweep, trajectories, or blocks of a Sobol' study."
)
@click.option("--no-second-order", "alone", is_flag=True, help="Sobol: leave out pairs, for nearly half the designs.")
@click.option("--study", help="Name of the study's folder; the method where not given.")
@click.option("--store", type=_FILE, help="Folder of the campaign's results; results/NAME where not given.")
@click.option("--workers", type=click.IntRange(1, 256), help="Processes at a time; the campaign's where not given.")
@click.option("--fresh", is_flag=True, help="Begin anew; an existing study is moved aside, not deleted.")
def sensitivity(
    campaign: Path,
    method: str,
    parameters: tuple[str, ...],
    samples: int | None,
    alone: bool,
    study: str | None,
    store: Path | None,
    workers: int | None,
    fresh: bool,
) -> None:
    """Say which parameters matter: one at a time, or all together with their interactions.

    \b
    oat     sweeps one parameter at a time, the others where the campaign has them
    morris  elementary effects: cheap, to sort out what does not matter
    sobol   the share of each, alone and with others, in the variance of every quantity

    \b
    divideropt sensitivity campaigns/divider.yaml
    divideropt sensitivity campaigns/divider.yaml --method sobol --samples 16384
    divideropt sensitivity campaigns/divider.yaml --parameter 'stem_ratio=0.1..0.6' --study stem
    """  # noqa: D301 (\b is click's)
    asked = _load(campaign)
    from divideropt.campaign.study import Asked, check_home, run_study, study_of, study_store
    from divideropt.report import read_study, study_text, write_study
    from divideropt.store import Store

    wanted = study_of(asked, Asked(method, parameters, samples, alone))
    folder = store or Path("results") / asked.name
    given = {"--method": method, "--samples": samples, "--study": study, "--store": store}
    options = [word for key, value in given.items() if value is not None for word in (key, str(value))]
    options += ["--no-second-order"] if alone else []
    chosen = [word for name in parameters for word in ("--parameter", name)]
    again = shlex.join(["divideropt", "sensitivity", str(campaign), *options, *chosen])
    check_home(Store(folder), asked)
    kept = study_store(Store(folder), method if study is None else study)
    run_study(wanted, kept, workers, sys.stderr, again, fresh=fresh)
    found = None if method == "oat" else read_study(kept)
    if found is not None:
        _write_data(study_text(found) + "\n")
    _say(f"report: {write_study(kept, data=found)}")


@commands.command()
@click.argument("designs", type=_FILE)
@click.option("--campaign", type=_FILE, help="Whose model, scenario and parameters; divider.yaml's where not given.")
@click.option("--out", type=_FILE, help="A .csv or .parquet file; CSV to standard output where not given.")
def evaluate(designs: Path, campaign: Path | None, out: Path | None) -> None:
    """Evaluate every design of a CSV file: columns are parameters by name, SI."""
    settings = _load(campaign)
    _check_out(out, (".csv", ".parquet"), designs)
    from divideropt.campaign.designs import evaluate_designs, read_designs
    from divideropt.campaign.plan import build_model

    model = build_model(settings)
    asked = read_designs(designs, tuple(model.parameters.values()))
    _write_table(evaluate_designs(asked, model, settings.model.base_parameters()), out)


@commands.command()
@click.argument("campaign", type=_FILE, required=False)
@_SET
@_SCENARIO
@click.option("--out", type=_FILE, help="A .csv, .parquet or .html file; CSV to standard output where not given.")
def simulate(campaign: Path | None, settings: tuple[str, ...], scenario: str, out: Path | None) -> None:
    """Simulate one response: a table, or a picture (.html)."""
    asked = _load(campaign)
    _check_out(out, (".csv", ".parquet", ".html"))
    from divideropt.campaign.simulate import simulate as simulate_one

    response = simulate_one(asked, settings, scenario)
    if out is not None and out.suffix == ".html":
        from divideropt.report import write_response

        write_response(response, out)
        _say(f"picture: {out}")
    else:
        _write_table(response.table, out)
    _say(f"outcome: {response.verdict.outcome} {response.verdict.text}".rstrip())


@commands.command()
@click.argument("campaign", type=_FILE, required=False)
@_SET
@_SCENARIO
@click.option("--out", type=_FILE, help="A .csv or .parquet file; CSV to standard output where not given.")
def error_budget(campaign: Path | None, settings: tuple[str, ...], scenario: str, out: Path | None) -> None:
    """Say what the steady-state error of one design is made of, in percent."""
    asked = _load(campaign)
    _check_out(out, (".csv", ".parquet"))
    from divideropt.campaign.budget import budget_table

    table, verdict = budget_table(asked, settings, scenario)
    _write_table(table, out)
    _say(f"outcome: {verdict.outcome} {verdict.text}".rstrip())


@commands.command()
@click.argument("campaign", type=_FILE)
def check(campaign: Path) -> None:
    """Read a campaign and say every mistake in it, or what it would run."""
    asked = _load(campaign)
    from divideropt.campaign.plan import plan_runs

    runs = plan_runs(asked)
    budget = sum(run.budget for run in runs)
    _say(f"{campaign}: right. {len(runs)} runs, at most {budget} evaluations: {', '.join(r.name for r in runs)}")


@commands.command()
def schema() -> None:
    """Print the JSON schema of campaigns, for editors."""
    import json

    from divideropt.campaign.dump import campaign_schema

    _write_data(json.dumps(campaign_schema(), indent=2, ensure_ascii=False) + "\n")


def _status_lines(found: "StoreStatus") -> list[str]:
    """Word a status, that of the companion after that of its campaign."""
    verified = "" if found.front is None else f", {found.verified} of them verified, {found.deviating} deviating"
    lines = [f"{found.campaign}: {_count(found.front)} designs on the combined front{verified}"]
    lines += [] if found.kkt is None else [_converged(found.kkt)]
    for item in found.runs:
        outcomes = ", ".join(f"{number} {name}" for name, number in item.outcomes.items())
        best = "" if item.best is None else f"; best max λ {item.best:.4f} ({item.best_design})"
        volume = "" if item.hypervolume is None else f"; hypervolume {item.hypervolume:.4f}"
        lines.append(f"{item.run}: {item.evaluations} of {item.budget} evaluations ({outcomes}){best}{volume}")
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
    return f"nominal: {known} of {points} designs of its front simulated in the whole campaign, {feasible} feasible"


def _load(path: Path | None) -> "Campaign":
    from divideropt.campaign.reader import read_document

    document = None if path is None else read_document(path)  # before the rest is imported, which takes a second
    from divideropt.campaign.load import campaign_of, default_campaign

    _say_when_compiling()
    return default_campaign() if document is None else campaign_of(document)


def _say_when_compiling() -> None:
    from divideropt.campaign.compiling import say_when_compiling

    say_when_compiling(sys.stderr)


def _check_out(out: Path | None, known: tuple[str, ...], read: Path | None = None) -> None:
    """Refuse an output that cannot be written, or that would replace what is read or belongs to a store."""
    if out is None:
        return
    if out.suffix not in known:
        raise UsageError(f"--out {out}: the name must end in {' or '.join(known)}")
    if not out.parent.is_dir():
        raise UsageError(f"--out {out}: there is no folder {out.parent}; make it first")
    if read is not None and out.exists() and read.exists() and out.samefile(read):
        raise UsageError(f"--out {out}: that is the file to be read; name another")
    whole = out.resolve()
    stores = [p for p in whole.parents if (p / "campaign.yaml").is_file() and (p / "evaluations").is_dir()]
    if stores and whole != stores[0] / "report.html":
        raise UsageError(f"--out {out}: that is inside the store {stores[0]}; name a file elsewhere")


def _write_table(table: "pd.DataFrame", out: Path | None) -> None:
    if out is None:
        _write_data(table.to_csv(index=False))
        return
    from divideropt.store.files import publish

    def write(path: Path) -> Any:
        return table.to_parquet(path, index=False) if out.suffix == ".parquet" else table.to_csv(path, index=False)

    publish(out, write)


def _write_data(text: str) -> None:
    """Write to standard output; a reader who has seen enough is no mistake, a full disk is."""
    if sys.stdout is None:
        raise DiskError("standard output is closed; give --out, or let it be open")
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise DiskError(f"standard output: {error.strerror}; nothing in a store was touched") from error


def _counted(count: "Tally") -> str:
    """Say how front points came out when they were simulated again."""
    largest = ", ".join(f"{name} {value:.1e}" for name, value in count.largest.items() if value is not None)
    words = f"verified: {count.agree} of {count.points} front points, {count.deviate} deviate"
    return f"{words}; largest deviation: {largest}" if largest else words


def _converged(kkt: "Convergence") -> str:
    """Say how near to stationary front points are."""
    others = f", {kkt.not_defined} not defined" if kkt.not_defined else ""
    if kkt.median is None:
        return f"KKT residual of 0 front points{others}"
    figures = f"median {kkt.median:.2g}, 95th percentile {kkt.high:.2g}"
    return f"KKT residual of {kkt.computed} front points: {figures}{others}"


def _incomplete(folder: Path, failures: "Mapping[str, str]", runs: int, again: str) -> IncompleteRunsError:
    reasons = "\n  ".join(f"{name}: {reason}" for name, reason in failures.items())
    return IncompleteRunsError(
        f"{folder}: {len(failures)} of {runs} runs are incomplete; fronts and report hold what was logged:\n"
        f"  {reasons}\nTo try them again from their logs:\n  {again}"
    )


def _count(number: int | None) -> str:
    return "no" if number is None else str(number)


def _say(words: str) -> None:
    with suppress(OSError):  # nobody to hear it
        click.echo(words, err=True)
