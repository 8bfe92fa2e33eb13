"""The reference has every public name, and every key of a campaign."""

import inspect
import json
import re
import types

import pytest
from campaignkeys import campaign_keys
from click.testing import CliRunner

import divideropt
import divideropt.api
from divideropt.cli import commands


def described(site, page):
    """The names that a page of the reference describes."""
    return set(re.findall(r'<dt class="sig[^>]* id="([\w.]+)"', (site / "reference" / page).read_text("utf-8")))


def test_every_function_for_notebooks_is_described(site):
    assert {f"divideropt.{name}" for name in divideropt.__all__} <= described(site, "api.html")


@pytest.mark.parametrize(
    "made", [name for name in divideropt.api.__all__ if inspect.isclass(getattr(divideropt.api, name))]
)
def test_what_they_return_is_described_member_by_member(site, made):
    kind, found = getattr(divideropt.api, made), described(site, "api.html")
    members = {name for name in vars(kind) if not name.startswith("_")} - {*inspect.get_annotations(kind)}
    assert {f"divideropt.api.{made}"} | {f"divideropt.api.{made}.{name}" for name in members} <= found


@pytest.mark.parametrize(
    ("page", "module"),
    [
        ("models.html", "divideropt.models"),
        ("problem.html", "divideropt.problem"),
        ("strategies.html", "divideropt.strategies"),
        ("store.html", "divideropt.store"),
        ("analysis.html", "divideropt.analysis"),
    ],
)
def test_every_public_name_of_a_package_is_described(site, page, module):
    found = {name.rpartition(".")[2] for name in described(site, page)}
    package = __import__(module, fromlist=["__all__"])
    kinds = (type, types.FunctionType)
    assert {name for name in package.__all__ if isinstance(getattr(package, name), kinds)} <= found


def test_every_key_of_the_schema_has_a_row():
    schema = json.loads(CliRunner().invoke(commands, ["schema"]).stdout)
    text = campaign_keys()
    for section in schema["$defs"].values():
        for name in section.get("properties", {}):
            assert f".{name}` |" in text
    for name in schema["properties"]:
        assert f"## {name}\n" in text


def test_a_row_says_unit_domain_and_default():
    row = re.search(r"\| `model\.scenario\.step\.to` \|.*", campaign_keys())[0]
    assert row.endswith("| in Pa, above 0 | `1.5e+07 Pa` |")
