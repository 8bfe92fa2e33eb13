"""One response, and one error budget, under a scenario that sets parameters."""

import pytest

from divideropt.campaign.budget import budget_table
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.simulate import chosen_design, simulate

OILS = """\
name: oils
model:
  kind: divider
  scenario: {step: {load: 1, to: 12 MPa}}
  scenarios:
    hot: {step: {load: 1, to: 12 MPa}, set: {kinematic_viscosity: 15 mm^2/s}}
    sticky: {step: {load: 1, to: 12 MPa}, set: {coulomb_friction: 10 N}}
    same: {step: {load: 1, to: 12 MPa}}
variables: {spool_radius: [6 mm, 16 mm]}
objectives: {load_regulation: }
strategies: {nsga2: {population: 8, generations: 2}}
"""
CAMPAIGN = parse_campaign(OILS)


def test_a_response_is_of_the_scenarios_oil():
    responses = {
        "hot": simulate(CAMPAIGN, [], "hot"),
        "said": simulate(CAMPAIGN, ["kinematic_viscosity=15 mm^2/s"], "same"),
        "same": simulate(CAMPAIGN, [], "same"),
        "base": simulate(CAMPAIGN, []),
    }
    assert all(response.verdict.ok for response in responses.values())
    assert responses["hot"].table.equals(responses["said"].table)
    assert responses["same"].table.equals(responses["base"].table)
    assert not responses["hot"].table.equals(responses["base"].table)


def test_what_is_said_for_one_response_goes_before_the_scenario():
    parameters = chosen_design(CAMPAIGN, ["kinematic_viscosity=40 mm^2/s"], "hot")[1]
    assert parameters["kinematic_viscosity"] == pytest.approx(40e-6)
    assert chosen_design(CAMPAIGN, [], "hot")[1]["kinematic_viscosity"] == pytest.approx(15e-6)
    assert chosen_design(CAMPAIGN, [], "same")[1]["kinematic_viscosity"] == pytest.approx(30e-6)


def test_an_error_budget_is_of_the_scenarios_friction():
    shares = {}
    for scenario in ("sticky", "same"):
        table, verdict = budget_table(CAMPAIGN, [], scenario)
        assert verdict.ok
        shares[scenario] = table.set_index("cause")["share"]
    assert shares["same"]["friction"] == 0.0
    assert abs(shares["sticky"]["friction"]) > 0.01  # it is there, and can be switched off
