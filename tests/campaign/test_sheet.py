"""A design's dimensions rounded: multiples of the step, simulated as any other design, and refused in a sentence."""

from decimal import Decimal
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import divideropt
from divideropt.campaign.designs import evaluate_designs, parse_designs
from divideropt.campaign.load import default_campaign, parse_campaign
from divideropt.campaign.plan import build_model
from divideropt.campaign.sheet import sheet, sheet_data, sheet_table
from divideropt.errors import UsageError

ROBUST = """
name: robust
model: {kind: divider, scenarios: {hot: {set: {kinematic_viscosity: 15 mm^2/s}}}}
variables: {spool_radius: [6 mm, 16 mm], total_pressure_drop: [2 MPa, 10 MPa]}
objectives:
  steady_state_error: {goal: 9 %, worst_of: all, statistic: p90}
  source_pressure: {goal: 18 MPa}
constraints: {stop_clearance: {min: 0 mm}, source_pressure: {max: 30 MPa}}
uncertainty:
  samples: 4
  parameters: {radial_clearance: {factor: {uniform: [0.8, 1.2]}}}
strategies: {nsga2: {population: 4, generations: 1, seeds: [1]}}
"""


def column(found, title):
    table = sheet_table(found)
    return dict(zip(table["name"][table["section"] != "constraint"], table[title], strict=False))


@pytest.mark.parametrize("step", ["0.01 mm", "0.1 mm", "250 um", "1 mm"])
def test_what_is_rounded_is_a_multiple_of_the_step_and_the_nearest(step):
    found = sheet(None, settings=["spool_radius=8.123 mm", "groove_width=1.377 mm", "stem_ratio=0.44"], step=step)
    width = Decimal(repr(found.step))
    assert set(found.names) == {
        "spool_diameter", "stem_diameter", "port_diameter", "port_opening", "groove_width",
        "fixed_orifice_diameter_1", "fixed_orifice_diameter_2",
    }  # fmt: skip
    for name in found.names:
        multiple = Decimal(repr(round(found.rounded.dimensions[name], 15))) / width
        assert abs(multiple - round(multiple)) < Decimal("1e-9"), name
        assert abs(found.rounded.dimensions[name] - found.exact.dimensions[name]) <= found.step / 2 * (1 + 1e-9)


def test_what_the_campaign_fixes_is_held_and_so_is_the_clearance():
    found = sheet(None, step="0.7 mm")
    for name in ("radial_clearance", "rim_thickness", "land_distance", "end_clearance", "spool_length"):
        assert found.rounded.dimensions[name] == found.exact.dimensions[name]
    varied = parse_campaign(
        "name: varied\nmodel: {kind: divider}\n"
        "variables: {rim_thickness: [0.1 mm, 2 mm], radial_clearance: [2 um, 4 um]}\n"
        "objectives: {source_pressure: {}}\nstrategies: {nsga2: {population: 4, generations: 1}}"
    )
    found = sheet(varied, step="0.7 mm")
    assert found.names == ("rim_thickness",)
    assert found.rounded.dimensions["rim_thickness"] == 0.7e-3


def test_the_objectives_after_rounding_are_those_of_the_rounded_design():
    campaign = default_campaign()
    found = sheet(campaign, settings=["spool_radius=13.317 mm", "groove_width=1.344 mm"], step="0.1 mm")
    names = list(found.rounded.parameters)
    text = pd.DataFrame([found.rounded.parameters])[names].to_csv(index=False)
    model = build_model(campaign)
    table = evaluate_designs(
        parse_designs(text, "designs", tuple(model.parameters.values())), model, campaign.model.base_parameters()
    )
    for i, objective in enumerate(found.problem.objectives):
        assert abs(table[objective.quantity.name][0]) == found.rounded.objectives[i]
    assert table["outcome"][0] == found.rounded.verdict.outcome
    assert found.rounded.objectives != found.exact.objectives


def test_scenarios_and_uncertainty_are_those_of_the_campaign():
    campaign = parse_campaign(ROBUST)
    found = sheet(campaign, settings=["spool_radius=13.317 mm"], step="0.1 mm")
    assert found.problem.objectives[0].quantity.name == "p90.worst.steady_state_error"
    rows = np.array(
        [[column.parameters[name] for name in found.problem.model.parameters] for column in found.columns]
    )
    values, _ = found.problem.model.evaluate(rows)
    place = list(found.problem.model.quantities).index("p90.worst.steady_state_error")
    assert [column.objectives[0] for column in found.columns] == values[:, place].tolist()
    data = sheet_data(found)
    assert data["goals"] == 2
    assert data["rounded_dimensions"]
    assert data["exact"]["feasible"] is found.exact.feasible


def test_a_design_of_a_store_is_the_one_that_was_logged(tmp_path: Path):
    text = (
        ROBUST.replace("generations: 1", "generations: 2")
        + "verification: {sample: 0}\noptimality: {points: 0}\nparallel: {backend: sequential}\n"
    )
    results = divideropt.run(text, tmp_path / "store")
    logged = pd.read_parquet(tmp_path / "store" / "evaluations" / "nsga2-1")
    row = logged[logged["design_id"] == "nsga2-1/6"].iloc[0]
    found = sheet(tmp_path / "store", "nsga2-1/6")
    assert found.rounded is None
    assert found.exact.parameters["spool_radius"] == row["spool_radius"]
    assert found.exact.objectives[1] == row["source_pressure"]
    assert str(found.exact.verdict.outcome) == row["outcome"]
    said = divideropt.sheet(results, "nsga2-1/6", set={"spool_radius": 0.0091}, step="0.1 mm")
    assert said.rounded["spool_radius"] == 0.0091
    assert said.write(tmp_path / "sheet.svg").read_text("utf-8").startswith("<svg ")
    assert list(pd.read_csv(said.write(tmp_path / "sheet.csv"))["name"]) == list(said.table["name"])
    assert "spool diameter" in str(said)
    with pytest.raises(UsageError, match="has no evaluation of a run nsga2-1-branch-1; its runs are nsga2-1"):
        sheet(tmp_path / "store", "nsga2-1-branch-1/6")
    for wrong in ("nsga2-1/900", "nsga2-2/0", "nonsense", "../nsga2-1/1"):
        with pytest.raises(UsageError, match=r"nsga2-|no design's id"):
            sheet(tmp_path / "store", wrong)
    with pytest.raises(UsageError, match="say which of its designs"):
        sheet(tmp_path / "store")


@pytest.mark.parametrize(
    ("settings", "step", "words"),
    [
        ([], "10 mm", "groove_width is 1 mm, .* 10 mm it would be 0; take a step below 2 mm"),
        (["centred_opening=0.99"], "1 mm", "centred_opening would be 1, but must be above 0 and below 1"),
        ([], "0 mm", "is no length above 0"),
        ([], "0.1", "is no length above 0"),
        (["spool_radius=-1 mm"], "0.1 mm", "must be above 0"),
        (["nonsense=1 mm"], "0.1 mm", "is no parameter"),
    ],
)
def test_what_makes_no_valve_is_refused_in_a_sentence(settings, step, words):
    with pytest.raises(UsageError, match=words):
        sheet(None, settings=settings, step=step)


def test_a_failing_design_has_a_sheet_that_says_so():
    found = sheet(None, settings=["spool_radius=3 mm", "groove_width=2 mm", "fixed_drop_ratio=0.98"], step="0.1 mm")
    assert not found.rounded.verdict.ok or not found.rounded.feasible
    data = sheet_data(found)
    assert data["rounded_dimensions"] == list(found.names)
    table = sheet_table(found).set_index("name")
    assert table["rounded"]["outcome"] == str(found.rounded.verdict.outcome)


def test_a_sheet_says_where_the_model_no_longer_vouches_for_the_rounded_design():
    settings = ["spool_radius=13.463 mm", "groove_width=1.0305 mm", "total_pressure_drop=6.4807 MPa"]
    settings += ["fixed_drop_ratio=0.88741", "centred_opening=0.25758", "radial_clearance=3 um"]
    finer, coarser = (sheet(None, settings=settings, step=step) for step in ("0.1 mm", "0.05 mm"))
    assert finer.exact.valid
    assert finer.rounded.valid
    assert not coarser.rounded.valid
    assert sheet_data(coarser)["rounded"]["within_validity"] is False
    assert sheet_table(coarser).set_index("name")["rounded"]["within_validity"] == "no"
