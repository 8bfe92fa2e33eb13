"""The commands that simulate designs: simulate, evaluate, sheet, error-budget."""

from pathlib import Path

import click

from divideropt.cli.output import (
    AS_JSON,
    FILE,
    check_out,
    load,
    say,
    say_when_compiling,
    write_data,
    write_json,
    write_table,
    write_text,
)
from divideropt.cli.teaching import Taught

# ruff: noqa: PLC0415 (what takes time is imported where it is needed)

SET = click.option(
    "--set", "settings", multiple=True, metavar="NAME=VALUE", help="A parameter, such as spool_radius='9 mm'."
)
SCENARIO = click.option("--scenario", default="scenario", metavar="NAME", help="One of the campaign's `scenarios`.")


@click.command(
    cls=Taught,
    examples=(
        "divideropt simulate --set 'spool_radius=9 mm' --out response.html",
        "divideropt simulate my.yaml --set 'groove_width=1 mm' > response.csv",
        "divideropt simulate --set 'spool_radius=9 mm' --json    # every metric and the outcome",
    ),
)
@click.argument("campaign", type=FILE, required=False)
@SET
@SCENARIO
@click.option("--out", type=FILE, help="A .csv, .parquet or .html file; CSV to standard output where not given.")
@click.option("--json", "as_json", is_flag=True, help="Outcome, parameters and metrics as JSON on standard output.")
def simulate(
    campaign: Path | None, settings: tuple[str, ...], scenario: str, out: Path | None, as_json: bool
) -> None:
    """Simulate one response: a table, a picture (.html), or its metrics (--json).

    Without CAMPAIGN, the thesis's valve as divider.yaml has it.
    """
    asked = load(campaign)
    check_out(out, (".csv", ".parquet", ".html"))
    from divideropt.campaign.simulate import response_data
    from divideropt.campaign.simulate import simulate as simulate_one

    response = simulate_one(asked, settings, scenario)
    if out is not None and out.suffix == ".html":
        from divideropt.report import write_response

        write_response(response, out)
        say(f"picture: {out}")
    elif out is not None or not as_json:
        write_table(response.table, out)
    if as_json:
        write_json(response_data(response))
    say(f"outcome: {response.verdict.outcome} {response.verdict.text}".rstrip())


@click.command(
    cls=Taught,
    examples=(
        "divideropt evaluate designs.csv > results.csv",
        "divideropt evaluate designs.csv --campaign my.yaml --out results.parquet",
        "divideropt evaluate results/my-csv/fronts/combined.csv > again.csv    # of what `export` wrote",
    ),
)
@click.argument("designs", type=FILE)
@click.option("--campaign", type=FILE, help="Whose model, scenario and parameters; divider.yaml's where not given.")
@click.option("--out", type=FILE, help="A .csv or .parquet file; CSV to standard output where not given.")
def evaluate(designs: Path, campaign: Path | None, out: Path | None) -> None:
    """Evaluate every design of a CSV file: columns are parameters by name, SI.

    A design that fails is a row like any other, with its outcome. A column `design_id` is passed through, and columns
    of results, as `export` and this command write them, are passed over.
    """
    settings = load(campaign)
    check_out(out, (".csv", ".parquet"), designs)
    from divideropt.campaign.designs import evaluate_designs, read_designs, result_columns
    from divideropt.campaign.plan import build_model

    model = build_model(settings)
    asked = read_designs(designs, tuple(model.parameters.values()), result_columns(model))
    if asked.passed_over:
        say(f"{designs}: {len(asked.passed_over)} columns of results are passed over: {asked.passed_over[0]}, …")
    write_table(evaluate_designs(asked, model, settings.model.base_parameters()), out)


@click.command(
    cls=Taught,
    examples=(
        "divideropt error-budget --set 'spool_radius=9 mm'",
        "divideropt error-budget my.yaml --out budget.csv",
    ),
)
@click.argument("campaign", type=FILE, required=False)
@SET
@SCENARIO
@click.option("--out", type=FILE, help="A .csv or .parquet file; CSV to standard output where not given.")
def error_budget(campaign: Path | None, settings: tuple[str, ...], scenario: str, out: Path | None) -> None:
    """Say what the steady-state error of one design is made of, in percent."""
    asked = load(campaign)
    check_out(out, (".csv", ".parquet"))
    from divideropt.campaign.budget import budget_table

    table, verdict = budget_table(asked, settings, scenario)
    write_table(table, out)
    say(f"outcome: {verdict.outcome} {verdict.text}".rstrip())


@click.command(
    cls=Taught,
    examples=(
        "divideropt sheet results/my nsga2-1/310 --step '0.1 mm'",
        "divideropt sheet results/my nsga2-1/310 --step '0.1 mm' --out sheet.svg    # drawn to scale",
        "divideropt sheet results/my nsga2-1/310 --step '0.1 mm' --out valve.yaml    # `set:` of the rounded design",
        "divideropt sheet my.yaml --set 'spool_radius=13.3 mm' --out sheet.csv",
    ),
)
@click.argument("source", type=FILE, required=False)
@click.argument("design", required=False)
@SET
@click.option(
    "--step", metavar="LENGTH", help="Round the dimensions to multiples of it, and simulate again: '0.1 mm'."
)
@click.option("--out", type=FILE, help="A .csv, .svg or .yaml file; a table on standard output where not given.")
@AS_JSON
def sheet(
    source: Path | None,
    design: str | None,
    settings: tuple[str, ...],
    step: str | None,
    out: Path | None,
    as_json: bool,
) -> None:
    """List a design's dimensions, and with --step what it does when they are rounded.

    SOURCE is a store, whose design <run>/<index> is named by DESIGN, or a campaign, whose design is --set; without
    it, the thesis's valve as divider.yaml has it. Rounded is what hangs on a variable and is made to a figure:
    diameters of spool, stems, ports and fixed orifices, groove, opening. The clearance is a fit, and is held.
    A .yaml file has the design, rounded with --step, as `set:` of a campaign's model, and the line that simulates it.
    """
    check_out(out, (".csv", ".svg", ".yaml"))
    say_when_compiling()
    from divideropt.campaign.sheet import sheet as sheet_of
    from divideropt.campaign.sheet import sheet_data, sheet_table, sheet_yaml
    from divideropt.report import sheet_svg, sheet_text

    found = sheet_of(source, design, settings, step)
    if out is not None and out.suffix == ".svg":
        write_text(sheet_svg(found), out)
    elif out is not None and out.suffix == ".yaml":
        write_text(sheet_yaml(found), out)
    elif out is not None:
        write_table(sheet_table(found), out)
    elif not as_json:
        write_data(sheet_text(found))
    if out is not None:
        say(f"sheet: {out}")
    if as_json:
        write_json(sheet_data(found))
    last = found.columns[-1].verdict
    say(f"outcome: {last.outcome} {last.text}".rstrip())
