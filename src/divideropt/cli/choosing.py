"""The commands that help to decide: compare, sensitivity."""

import shlex
import sys
from pathlib import Path

import click

from divideropt.cli.output import AS_JSON, FILE, WORKERS, check_out, load, say, write_data, write_json, write_table
from divideropt.cli.teaching import Taught

# ruff: noqa: PLC0415 (what takes time is imported where it is needed)


@click.command(
    cls=Taught,
    examples=(
        "divideropt compare results/my",
        "divideropt compare results/my results/second --at 200",
        "divideropt compare results/my --json --out indicators.csv",
    ),
)
@click.argument("stores", type=FILE, nargs=-1, required=True, metavar="STORE...")
@click.option("--at", "evaluations", type=click.IntRange(1), help="After so many evaluations of each run.")
@AS_JSON
@click.option("--out", type=FILE, help="A .csv or .parquet file for the indicators of each run.")
def compare(stores: tuple[Path, ...], evaluations: int | None, as_json: bool, out: Path | None) -> None:
    """Compare strategies over their seeds, in one store or several of one problem; then help to choose a design."""
    check_out(out, (".csv", ".parquet"))
    from divideropt.campaign.compare import compare_stores
    from divideropt.report import comparison_data, comparison_table, comparison_text

    found = compare_stores(stores, evaluations)
    if out is not None:
        write_table(comparison_table(found), out)
    if as_json:
        write_json(comparison_data(found))
    else:
        write_data(comparison_text(found))
    for sentence in found.words:
        say(sentence)


@click.command(
    cls=Taught,
    examples=(
        "divideropt sensitivity my.yaml",
        "divideropt sensitivity my.yaml --method sobol --samples 4096",
        "divideropt sensitivity my.yaml --parameter 'stem_ratio=0.1..0.6' --study stem",
    ),
)
@click.argument("campaign", type=FILE)
@click.option("--method", type=click.Choice(["oat", "morris", "sobol"]), default="oat", show_default=True)
@click.option("--parameter", "parameters", multiple=True, metavar="NAME[=LOWER..UPPER]", help="Study this instead.")
@click.option(
    "--samples", type=click.IntRange(2), help="Points of a sweep, trajectories, or blocks of a Sobol' study."
)
@click.option("--no-second-order", "alone", is_flag=True, help="Sobol: leave out pairs, for nearly half the designs.")
@click.option("--study", help="Name of the study's folder; the method where not given.")
@click.option("--store", type=FILE, help="Folder of the campaign's results; results/NAME where not given.")
@WORKERS
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
    """  # noqa: D301 (\b is click's)
    asked = load(campaign)
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
        write_data(study_text(found) + "\n")
    say(f"report: {write_study(kept, data=found)}")
