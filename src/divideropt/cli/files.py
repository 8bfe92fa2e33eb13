"""The commands around a campaign's file: init, check, schema."""

from pathlib import Path

import click

from divideropt.cli.output import AS_JSON, FILE, load, plural, say, write_data, write_json
from divideropt.cli.teaching import Taught
from divideropt.errors import FileMistakes

# ruff: noqa: PLC0415 (what takes time is imported where it is needed)

TEMPLATES = ("divider", "quickstart")
"""What `init` may begin with."""


@click.command(
    cls=Taught,
    examples=(
        "divideropt init",
        "divideropt init my.yaml --template quickstart",
        "divideropt init valve.yaml --schema    # and its JSON schema beside it, for an editor",
    ),
)
@click.argument("file", type=FILE, default=Path("campaign.yaml"))
@click.option(
    "--template",
    type=click.Choice(TEMPLATES),
    default="divider",
    show_default=True,
    help="divider: the thesis's problem, a full study; quickstart: the same in some seconds, its fronts rough.",
)
@click.option("--schema", "with_schema", is_flag=True, help="Write FILE's JSON schema beside it, and refer to it.")
def init(file: Path, template: str, with_schema: bool) -> None:
    """Write a commented campaign to start from; an existing file is never replaced.

    The campaign is called as its file, so that its results get a folder of their own.
    """
    from divideropt.campaign.begin import begin_campaign

    for path in begin_campaign(file, template, with_schema=with_schema):
        say(f"written: {path}")
    say(f"next: change it in an editor, then\n  divideropt check {file}\n  divideropt run {file}")


@click.command(
    cls=Taught,
    examples=(
        "divideropt check my.yaml",
        "divideropt check my.yaml --json",
    ),
)
@click.argument("campaign", type=FILE)
@AS_JSON
def check(campaign: Path, as_json: bool) -> None:
    """Read a campaign and say every mistake in it, or what it would run."""
    try:
        asked = load(campaign, to_simulate=False)
    except FileMistakes as error:
        if as_json:
            found = [{"line": m.line, "column": m.column, "message": m.message} for m in error.mistakes]
            write_json({"right": False, "mistakes": found})
        raise
    from divideropt.campaign.divider import DividerConfig
    from divideropt.campaign.plan import build_problem, plan_data

    if not isinstance(asked.model, DividerConfig):
        from divideropt.store import TableSchema

        TableSchema.of(build_problem(asked))  # refuses names that `run` could not put into the tables
    plan = plan_data(asked)
    if as_json:
        write_json({"right": True, **plan})
        return
    names = ", ".join(run["run"] for run in plan["runs"])
    most = plural(plan["budget"], "evaluation")
    say(f"{campaign}: right. {plural(len(plan['runs']), 'run')}, at most {most}: {names}")


@click.command(
    cls=Taught,
    examples=(
        "divideropt schema > divideropt.schema.json",
        "# and as the first line of a campaign:",
        "# yaml-language-server: $schema=divideropt.schema.json",
    ),
)
def schema() -> None:
    """Print the JSON schema of campaigns, by which an editor completes and checks them."""
    import json

    from divideropt.campaign.dump import campaign_schema

    write_data(json.dumps(campaign_schema(), indent=2, ensure_ascii=False) + "\n")
