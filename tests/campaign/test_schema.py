"""The JSON schema has what the code has: every section, every field, every option of a strategy, and no other."""

import dataclasses

import pytest
from jsonschema import Draft202012Validator

from divideropt.campaign.config import Campaign
from divideropt.campaign.dump import campaign_schema
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.reader import read_text
from divideropt.campaign.sections import Section
from divideropt.errors import FileMistakes
from divideropt.models.divider import PARAMETERS, QUANTITIES
from divideropt.strategies import METHODS

SCHEMA = campaign_schema()
VALID = Draft202012Validator(SCHEMA)

WHOLE = """
name: whole
model:
  kind: divider
  formulation: conservative
  parameters: thesis_base
  groove_loss: entrance
  set: {radial_clearance: 3 um}
  scenario: {source_flow: 1e-3 m^3/s, spool_position: 0.5, load_pressures: [10 MPa, 10 MPa], start: settled}
  scenarios: {hot: {set: {kinematic_viscosity: 15 mm^2/s}}}
  solver: {method: rosenbrock, rtol: 1e-4}
variables: {spool_radius: [6 mm, 16 mm], groove_width: [0.6 mm, 2 mm]}
objectives:
  steady_state_error: {goal: 0.5 %, weight: 3, worst_of: all, statistic: p95}
  source_pressure: {goal: 18 MPa}
constraints: {source_pressure: {min: 1 MPa, max: 30 MPa}, failed_share: {max: 5 %}}
reference_point: {steady_state_error: 10 %, source_pressure: 30 MPa}
uncertainty:
  samples: 4
  parameters: {radial_clearance: {uniform: [2 um, 4 um]}}
strategies:
  nsga2: {population: 8, generations: 4, seeds: [1], termination: {goals: true}}
nominal: true
verification: {sample: 2, extremes: false, tolerance: 1 %}
optimality: {points: 3}
sensitivity: {parameters: {stem_ratio: [0.1, 0.6]}, oat: {points: 5}, morris: {trajectories: 10}, seed: 2}
parallel: {workers: 2, backend: sequential}
"""


def sections(kind=Section):
    """Every section of a campaign for the divider."""
    for member in kind.__subclasses__():
        if "Plugin" not in member.__name__:
            yield member
            yield from sections(member)


def test_it_has_every_section_of_a_campaign():
    assert SCHEMA["properties"].keys() == Campaign.model_fields.keys()
    assert SCHEMA["additionalProperties"] is False


@pytest.mark.parametrize("name", sorted(SCHEMA["$defs"]))
def test_a_section_has_the_fields_of_its_class(name):
    known = {kind.__name__: kind for kind in sections()}
    part = SCHEMA["$defs"][name]
    if name not in known:  # a measure that several fields share
        assert name.startswith("Measure")
        return
    assert set(part["properties"]) == set(known[name].model_fields)
    assert part["additionalProperties"] is False


@pytest.mark.parametrize("name", METHODS)
def test_a_strategy_has_the_options_of_its_class(name):
    found = SCHEMA["properties"]["strategies"]["properties"][name]["properties"]
    options = {field.name for field in dataclasses.fields(METHODS[name])}
    assert set(found) == options | {"seeds", "termination"}


def test_what_hangs_on_names_has_them_all():
    study = SCHEMA["$defs"]["SensitivityConfig"]["properties"]["parameters"]
    uncertain = SCHEMA["$defs"]["UncertaintyConfig"]["properties"]["parameters"]
    settings = SCHEMA["$defs"]["DividerConfig"]["properties"]["set"]
    for part in (study, uncertain, settings, SCHEMA["properties"]["variables"]):
        assert part["properties"].keys() == PARAMETERS.keys()
    for name in ("objectives", "constraints", "reference_point"):
        assert SCHEMA["properties"][name]["properties"].keys() == {*QUANTITIES, "failed_share"}


def test_a_campaign_with_every_section_fits_the_loader_and_the_schema():
    assert set(read_text(WHOLE).data) == set(Campaign.model_fields)
    parse_campaign(WHOLE)
    assert [error.message for error in VALID.iter_errors(read_text(WHOLE).data)] == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("stem_ratio: [0.1, 0.6]", "stem_ration: [0.1, 0.6]"),
        ("trajectories: 10", "trajectory: 10"),
        ("trajectories: 10", "trajectories: 1"),
        ("uniform:", "uniforme:"),
        ("samples: 4", "sample: 4"),
        ("nominal: true", "nominal: perhaps"),
        ("{set: {kinematic_viscosity: 15 mm^2/s}}", "{sets: {kinematic_viscosity: 15 mm^2/s}}"),
        ("kinematic_viscosity: 15 mm^2/s", "viscosity: 15 mm^2/s"),
        ("kinematic_viscosity: 15 mm^2/s", "kinematic_viscosity: 15"),
        ("statistic: p95", "statistic: p00"),
        ("points: 3", "points: -3"),
        ("extremes: false", "extreme: false"),
        ("goals: true", "goal: true"),
    ],
)
def test_what_the_loader_refuses_of_it_the_schema_refuses(old, new):
    text = WHOLE.replace(old, new)
    assert text != WHOLE
    with pytest.raises(FileMistakes):
        parse_campaign(text)
    assert not VALID.is_valid(read_text(text).data)
