"""`divideropt sheet`: what it writes, where, and what it refuses."""

import json
import shlex
import xml.etree.ElementTree as ET

import pandas as pd
import pytest
from click.testing import CliRunner
from ruamel.yaml import YAML

import divideropt
from divideropt.campaign.load import default_campaign, parse_campaign
from divideropt.campaign.plan import build_model
from divideropt.campaign.simulate import read_settings
from divideropt.cli import commands
from divideropt.errors import UsageError

REST = "objectives: {source_pressure: {goal: 18 MPa}}\nstrategies: {nsga2: {}}\n"
GIVEN = ["sheet", "--set", "spool_radius=8.123 mm", "--step", "0.1 mm"]


def test_the_table_is_for_people_and_json_for_programs():
    shown = CliRunner().invoke(commands, GIVEN)
    assert shown.exit_code == 0
    assert "a design of divider, as it is and rounded to 0.1 mm" in shown.stdout
    assert "outcome: ok" in shown.stderr
    data = json.loads(CliRunner().invoke(commands, [*GIVEN, "--json"]).stdout)
    spool = data["dimensions"]["spool_diameter"]
    assert (spool["kind"], spool["unit"], spool["rounded"]) == ("diameter", "m", 0.0162)
    assert data["parameters"]["spool_radius"]["rounded"] == 0.0081
    assert data["rounded"]["outcome"] == "ok"
    assert f"{data['objectives']['source_pressure']['rounded'] / 1e6:.5g}" in shown.stdout


def test_without_a_step_nothing_is_rounded():
    data = json.loads(CliRunner().invoke(commands, ["sheet", "--json"]).stdout)
    assert data["step"] is None
    assert data["rounded_dimensions"] == []
    assert "rounded" not in data
    assert data["dimensions"]["spool_diameter"]["exact"] == 0.016


def test_a_sheet_is_a_file_by_its_ending(tmp_path):
    for ending in ("csv", "svg"):
        done = CliRunner().invoke(commands, [*GIVEN, "--out", str(tmp_path / f"sheet.{ending}")])
        assert (done.exit_code, done.stdout) == (0, "")
    table = pd.read_csv(tmp_path / "sheet.csv").set_index(["section", "name"])
    assert float(table.loc[("diameter", "spool_diameter"), "rounded"]) == 0.0162
    assert table.loc[("outcome", "outcome"), "rounded"] == "ok"
    text = (tmp_path / "sheet.svg").read_text("utf-8")
    assert "var(" not in text
    words = " ".join(ET.fromstring(text).itertext())
    assert "spool diameter" in words
    assert "16.2" in words


def test_yaml_is_the_rounded_design_as_a_campaigns_set(tmp_path):
    out = tmp_path / "valve.yaml"
    done = CliRunner().invoke(commands, [*GIVEN, "--set", "stem_ratio=0.5", "--out", str(out)])
    assert (done.exit_code, done.stdout) == (0, "")
    text = out.read_text("utf-8")
    comment, line, *_ = text.splitlines()
    assert comment == "# a design of campaign divider, rounded to 0.1 mm"
    settings = YAML(typ="safe").load(text)["set"]
    table = divideropt.sheet(set={"spool_radius": "8.123 mm", "stem_ratio": 0.5}, step="0.1 mm")
    rounded = table.rounded
    assert settings.keys() == {*default_campaign().variables, "stem_ratio"}
    model = f"model: {{kind: divider, set: {json.dumps(settings)}}}"
    made = parse_campaign(f"name: a\n{model}\nvariables: {{rim_thickness: [0.5 mm, 1 mm]}}\n{REST}")
    assert made.model.set == {name: rounded[name] for name in settings}
    words = shlex.split(line.removeprefix("# divideropt simulate campaign.yaml"))
    assert read_settings(words[1::2], build_model(made).parameters) == dict(made.model.set)
    assert table.write(tmp_path / "again.yaml").read_text("utf-8") == text


@pytest.mark.parametrize(
    "step",
    ["", " ", "foo", "0", "0 mm", "-1 mm", "0.1", "inf", "inf m", "nan m", "1 s", "1e-60 m", "1e60 m", "1 mmm"],
)
def test_a_step_is_a_length(step):
    with pytest.raises(UsageError) as caught:
        CliRunner().invoke(commands, [*GIVEN[:3], "--step", step], catch_exceptions=False)
    sentence = "is no length above 0; write a number with its unit, such as '0.1 mm'"
    assert str(caught.value) == f"--step {step!r} {sentence}"


@pytest.mark.parametrize(("step", "shown"), [("1 nm", "1 nm"), ("1 um", "0.001 mm"), ("0.25 mm", "0.25 mm")])
def test_a_step_is_shown_as_a_drawing_has_it(step, shown):
    found = CliRunner().invoke(commands, [*GIVEN[:3], "--step", step])
    assert found.stdout.startswith(f"a design of divider, as it is and rounded to {shown}\n")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--out", "sheet.pdf"], "must end in .csv, .svg or .yaml"),
        (["nowhere.yaml"], "nowhere.yaml"),
        (["nowhere", "nsga2-1/3"], "is no store's folder; give the store first"),
        (["--set", "spool_radius=8 mm", "--set", "spool_radius=9 mm"], "given more than once"),
    ],
)
def test_a_wrong_call_is_said(arguments, words):
    done = CliRunner().invoke(commands, ["sheet", *arguments])
    assert isinstance(done.exception, UsageError)
    assert words in str(done.exception)
