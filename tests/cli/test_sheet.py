"""`divideropt sheet`: what it writes, where, and what it refuses."""

import json
import xml.etree.ElementTree as ET

import pandas as pd
import pytest
from click.testing import CliRunner

from divideropt.cli import commands
from divideropt.errors import UsageError

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


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--out", "sheet.pdf"], "must end in .csv or .svg"),
        (["nowhere.yaml"], "nowhere.yaml"),
        (["nowhere", "nsga2-1/3"], "is no store's folder; give the store first"),
        (["--set", "spool_radius=8 mm", "--set", "spool_radius=9 mm"], "given more than once"),
    ],
)
def test_a_wrong_call_is_said(arguments, words):
    done = CliRunner().invoke(commands, ["sheet", *arguments])
    assert isinstance(done.exception, UsageError)
    assert words in str(done.exception)
