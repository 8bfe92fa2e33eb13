"""What the README says is so."""

import re
import tomllib
from pathlib import Path

import pytest

from divideropt.campaign.load import load_campaign, parse_campaign
from divideropt.campaign.plan import plan_runs
from divideropt.cli import commands

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_its_campaign_is_right():
    block = re.search(r"## A campaign\n\n((?:    .*\n)+)", README)
    text = "\n".join(line[4:] for line in block[1].splitlines())
    campaign = parse_campaign(text, "README.md")
    assert [run.name for run in plan_runs(campaign)] == ["nsga2-1", "complex-1"]


def test_it_names_every_command_and_no_other():
    named = set(re.findall(r"`divideropt ([a-z-]+)", README))
    assert named == set(commands.commands)


@pytest.mark.parametrize("target", sorted(set(re.findall(r"\]\(([^)#]+)\)", README))))
def test_its_links_lead_somewhere(target):
    assert (ROOT / target).exists()


@pytest.mark.parametrize("path", sorted((ROOT / "campaigns").glob("*.yaml")), ids=lambda path: path.stem)
def test_each_campaign_it_offers_is_right_and_listed(path):
    assert load_campaign(path).name == path.stem
    assert f"campaigns/{path.name}" in README


def test_the_task_runner_has_the_tasks_that_contributing_names():
    named = set(re.findall(r"`poe ([a-z]+)", (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")))
    tasks = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["poe"]["tasks"]
    assert named == set(tasks)
