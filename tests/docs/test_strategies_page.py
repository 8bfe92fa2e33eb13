"""The page of strategies says what the strategies are."""

import dataclasses
import re
from pathlib import Path

import pytest

from divideropt.campaign.load import parse_campaign
from divideropt.campaign.plan import plan_runs
from divideropt.strategies import STRATEGIES
from divideropt.strategies.complex_moves import VARIANTS

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "how-to" / "strategies.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## (\w+)\n(.*?)(?=^## |\Z)", PAGE, re.DOTALL | re.MULTILINE))
SNIPPETS = re.findall(r"(?:^    .*\n)+", PAGE, re.MULTILINE)
QUICKSTART = (ROOT / "campaigns" / "quickstart.yaml").read_text(encoding="utf-8")


def campaign(snippet):
    """Put a snippet in the place of a campaign's own strategies."""
    lines = "".join(line[4:] for line in snippet.splitlines(keepends=True))
    text, count = re.subn(r"^strategies:.*\n(?:  .*\n)+", lambda _: lines, QUICKSTART, flags=re.MULTILINE)
    assert count == 1
    return parse_campaign(text, "strategies.md")


@pytest.mark.parametrize("snippet", SNIPPETS, ids=lambda snippet: snippet.split()[1])
def test_each_snippet_is_read_as_part_of_a_campaign(snippet):
    name = re.search(r"^      (\w+):", snippet, re.MULTILINE)[1]
    runs = plan_runs(campaign(snippet))
    assert {run.name.rsplit("-", 1)[0] for run in runs} == {name}


def test_every_strategy_has_a_section_with_a_snippet_and_no_other():
    assert set(SECTIONS) == set(STRATEGIES)
    for name, section in SECTIONS.items():
        assert f"\n      {name}: {{" in section


@pytest.mark.parametrize("name", STRATEGIES)
def test_every_option_is_explained_with_its_default(name):
    explained = SECTIONS[name] if "as for `nsga2`" not in SECTIONS[name] else SECTIONS[name] + SECTIONS["nsga2"]
    for option in dataclasses.fields(STRATEGIES[name]):
        assert f"`{option.name}`" in explained
        if isinstance(option.default, int):
            assert f"`{option.name}`, default {option.default}" in explained


def test_every_variant_of_the_complex_method_is_in_its_table():
    assert set(re.findall(r"^\| `(\w+)` \|", SECTIONS["complex"], re.MULTILINE)) == set(VARIANTS)


@pytest.mark.parametrize("target", sorted(set(re.findall(r"\]\(([^)#]+)\)", PAGE))))
def test_its_links_lead_somewhere(target):
    assert (ROOT / "docs" / "how-to" / target).exists()
