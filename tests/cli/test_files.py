"""init, check and schema: a campaign's file."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator
from ruamel.yaml import YAML

from divideropt.campaign import begin
from divideropt.campaign.begin import begin_campaign
from divideropt.campaign.load import load_campaign
from divideropt.cli import commands
from divideropt.cli.files import TEMPLATES
from divideropt.errors import FileMistakes, UsageError

CAMPAIGNS = Path(__file__).parents[2] / "campaigns"


@pytest.mark.parametrize("template", TEMPLATES)
def test_init_writes_a_right_campaign_that_is_called_as_its_file(tmp_path, template):
    done = CliRunner().invoke(commands, ["init", str(tmp_path / "my-valve.yaml"), "--template", template])
    assert done.exit_code == 0
    assert f"divideropt run {tmp_path / 'my-valve.yaml'}" in done.stderr
    assert done.stdout == ""
    text = (tmp_path / "my-valve.yaml").read_text(encoding="utf-8")
    assert text.startswith(f"# Begun from divideropt's {template}.yaml")
    assert text.count("#") > 5
    made = load_campaign(tmp_path / "my-valve.yaml")
    assert made.name == "my-valve"
    begun = load_campaign(CAMPAIGNS / f"{template}.yaml")
    assert made == begun.model_copy(update={"name": "my-valve"})


@pytest.mark.parametrize("template", TEMPLATES)
def test_a_template_is_the_campaign_of_its_name(template):
    shipped = Path(begin.__file__).with_name(f"{template}.yaml").read_bytes()
    assert shipped == (CAMPAIGNS / f"{template}.yaml").read_bytes()


def test_init_replaces_nothing(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text("mine", encoding="utf-8")
    for with_schema in (False, True):
        with pytest.raises(UsageError, match="is there already, and is not replaced"):
            begin_campaign(path, "divider", with_schema=with_schema)
    (tmp_path / "b.schema.json").write_text("mine", encoding="utf-8")
    with pytest.raises(UsageError, match=r"b\.schema\.json: is there already"):
        begin_campaign(tmp_path / "b.yaml", "divider", with_schema=True)
    assert path.read_text(encoding="utf-8") == "mine"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.yaml", "b.schema.json"]


@pytest.mark.parametrize(("name", "words"), [("a.txt", "must end in .yaml"), ("no/a.yaml", "there is no folder")])
def test_init_refuses_what_is_no_campaigns_place(tmp_path, name, words):
    with pytest.raises(UsageError, match=words):
        begin_campaign(tmp_path / name, "divider")


def test_a_name_that_no_folder_can_have_stays_the_templates(tmp_path):
    begin_campaign(tmp_path / "my valve.yaml", "quickstart")
    assert load_campaign(tmp_path / "my valve.yaml").name == "quickstart"


def test_init_can_write_the_schema_to_which_the_first_line_refers(tmp_path):
    begin_campaign(tmp_path / "a.yaml", "divider", with_schema=True)
    text = (tmp_path / "a.yaml").read_text(encoding="utf-8")
    hint, name = text.splitlines()[0].split("=")
    assert hint == "# yaml-language-server: $schema"
    schema = json.loads((tmp_path / name).read_text(encoding="utf-8"))
    assert schema == json.loads(CliRunner().invoke(commands, ["schema"]).stdout)
    Draft202012Validator(schema).validate(YAML(typ="safe").load(text))


def test_check_says_what_would_run_as_json(tmp_path):
    begin_campaign(tmp_path / "a.yaml", "quickstart")
    found = json.loads(CliRunner().invoke(commands, ["check", str(tmp_path / "a.yaml"), "--json"]).stdout)
    assert found["right"] is True
    assert [(r["run"], r["strategy"], r["seed"], r["budget"]) for r in found["runs"]] == [
        ("nsga2-1", "nsga2", 1, 320),
        ("complex-1", "complex", 1, 250),
    ]
    assert found["budget"] == 570
    assert found["objectives"] == ["steady_state_error", "dynamic_error", "source_pressure"]


def test_check_says_every_mistake_as_json(tmp_path):
    begin_campaign(tmp_path / "a.yaml", "quickstart")
    text = (tmp_path / "a.yaml").read_text(encoding="utf-8").replace("[6 mm, 16 mm]", "[16 mm, 6 mm]")
    (tmp_path / "a.yaml").write_text(text, encoding="utf-8")
    done = CliRunner().invoke(commands, ["check", str(tmp_path / "a.yaml"), "--json"])
    assert isinstance(done.exception, FileMistakes)
    found = json.loads(done.stdout)
    assert found["right"] is False
    line = next(i for i, words in enumerate(text.splitlines(), start=1) if "[16 mm, 6 mm]" in words)
    assert [m["line"] for m in found["mistakes"]] == [line]
