"""The commands as functions: what they return, what they refuse, and that they are what the commands are."""

import inspect
import io
import json
import shutil
import subprocess
import sys

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner

import divideropt
from divideropt.campaign.load import load_campaign, parse_campaign
from divideropt.cli import commands
from divideropt.errors import FileMistakes, UsageError
from divideropt.models.divider import QUANTITIES

CAMPAIGN = """
name: small
model: {kind: divider, set: {radial_clearance: 3 um}}
variables:
  spool_radius: [6 mm, 16 mm]
  total_pressure_drop: [2 MPa, 10 MPa]
objectives:
  steady_state_error: {goal: 0.5 %, weight: 3}
  dynamic_error: {goal: 0.5 mL, weight: 3}
constraints: {source_pressure: {max: 30 MPa}, stop_clearance: {min: 0 mm}}
reference_point: {steady_state_error: 10 %, dynamic_error: 10 mL}
strategies:
  nsga2: {population: 12, generations: 4, seeds: [1]}
  complex: {points: 6, evaluations: 40, seeds: [1]}
verification: {sample: 0, extremes: false}
parallel: {backend: sequential}
"""


@pytest.fixture(scope="module", name="ran")
def _ran(tmp_path_factory):
    """Results of a small campaign, and what was said."""
    words = io.StringIO()
    results = divideropt.run(CAMPAIGN, tmp_path_factory.mktemp("api") / "small", words=words)
    return results, words.getvalue()


def test_every_command_that_makes_something_is_a_function():
    functions = {name.replace("_", "-") for name in divideropt.__all__} - {"open"}
    assert functions == set(commands.commands) - {"init", "schema", "report"}  # files, and `open(store).report()`
    for name in divideropt.__all__:
        function = getattr(divideropt, name)
        assert inspect.signature(function).return_annotation is not inspect.Signature.empty
        assert "Raises:" in function.__doc__
    assert set(divideropt.__all__) <= set(dir(divideropt))
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        divideropt.nonsense  # noqa: B018


def test_importing_the_package_imports_no_library():
    code = (
        "import sys, divideropt; print(len([m for m in ('numpy', 'pandas', 'numba', 'click') if m in sys.modules]))"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "0\n"


def test_the_front_is_the_files_with_the_files_units(ran):
    results, said = ran
    front = results.front()
    file = results.folder / "fronts" / "combined.parquet"
    pd.testing.assert_frame_equal(front, pd.read_parquet(file), check_exact=True)
    assert "nsga2-1: 48 of 48 evaluations" in said
    for field in pq.read_schema(file):
        assert front.attrs["units"][field.name] == (field.metadata or {}).get(b"unit", b"").decode()
    assert front.attrs["symbols"]["spool_radius"] == "r"
    assert front.attrs["descriptions"]["source_pressure"] == QUANTITIES["source_pressure"].description
    assert front[results.variables].attrs["units"]["total_pressure_drop"] == "Pa"
    one = results.front("nsga2-1")
    assert one["run"].unique().tolist() == ["nsga2-1"]
    assert len(results.evaluations("complex-1")) == 40


def test_a_run_again_does_nothing_and_gives_the_same(ran):
    results, _ = ran
    words = io.StringIO()
    again = divideropt.run(CAMPAIGN, results.folder, words=words)
    assert "48 of 48 evaluations, 48 from the log (done)" in words.getvalue()
    pd.testing.assert_frame_equal(again.front(), results.front(), check_exact=True)
    assert repr(divideropt.open(results.folder)) == repr(again) == f"divideropt.open({str(results.folder)!r})"


def test_two_objectives_are_drawn_as_a_projection(ran):
    results, _ = ran
    front, figure = results.front(), results.plot_front()
    assert sum(len(trace.x) for trace in figure.data) == len(front)
    assert sorted(x for trace in figure.data for x in trace.x) == pytest.approx(
        sorted(front["steady_state_error"]), rel=1e-3
    )
    assert figure.layout.yaxis.title.text.startswith("dynamic error")
    with pytest.raises(UsageError, match="name a pair of objectives: dynamic_error and steady_state_error"):
        results.plot_front("steady_state_error", "source_pressure")
    with pytest.raises(UsageError, match="name a pair"):
        results.plot_front("steady_state_error")


def test_a_campaign_may_be_text_a_file_or_read(tmp_path):
    (tmp_path / "small.yaml").write_text(CAMPAIGN, encoding="utf-8")
    expected = divideropt.check(CAMPAIGN)
    assert expected["budget"].tolist() == [48, 40]
    for given in (tmp_path / "small.yaml", str(tmp_path / "small.yaml"), parse_campaign(CAMPAIGN)):
        pd.testing.assert_frame_equal(divideropt.check(given), expected)
    with pytest.raises(FileMistakes, match=r"campaign:5:17: "):
        divideropt.check(CAMPAIGN.replace("[6 mm, 16 mm]", "[16 mm, 6 mm]"))
    with pytest.raises(UsageError, match="no such file"):
        divideropt.check("nowhere.yaml")


def test_simulate_is_the_command(tmp_path):
    response = divideropt.simulate(CAMPAIGN, set={"spool_radius": "9 mm", "groove_width": 1.2e-3})
    (tmp_path / "small.yaml").write_text(CAMPAIGN, encoding="utf-8")
    call = ["simulate", str(tmp_path / "small.yaml"), "--set", "spool_radius=9 mm", "--set", "groove_width=1.2 mm"]
    said = json.loads(CliRunner().invoke(commands, [*call, "--json"]).stdout)
    assert (response.outcome, response.text) == (said["outcome"], said["text"]) == ("ok", "")
    for name, entry in said["quantities"].items():
        value = response.quantities.loc[name, "value"]
        assert response.quantities.loc[name, "unit"] == entry["unit"] == QUANTITIES[name].unit
        assert np.isnan(value) if entry["value"] is None else value == entry["value"]
    assert said["parameters"]["groove_width"] == {"value": 1.2e-3, "unit": "m"}
    assert said["quantities"]["within_validity"]["value"] in (True, False)
    table = pd.read_csv(io.StringIO(CliRunner().invoke(commands, call).stdout))
    pd.testing.assert_frame_equal(response.table, table, check_exact=False, rtol=1e-12)
    assert response.table.attrs["units"]["load_flow_1"] == "m^3/s"
    figure = response.plot()
    assert {trace.name for trace in figure.data} >= {"load flow 1", "source pressure", "spool displacement"}
    assert response.write(tmp_path / "r.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_a_design_of_the_store_comes_out_the_same(ran):
    results, _ = ran
    row = results.front().iloc[0]
    for response in (
        results.simulate(row["design_id"]),
        divideropt.simulate(row, campaign=results.campaign),
        divideropt.simulate(row[results.variables].to_dict(), campaign=CAMPAIGN),
    ):
        assert response.quantities.loc[results.objectives, "value"].tolist() == row[results.objectives].tolist()
    with pytest.raises(UsageError, match="no design nsga2-1/4000 in the log"):
        results.simulate("nsga2-1/4000")
    with pytest.raises(UsageError, match="no run 'nsga3-1'; there are nsga2-1, complex-1"):
        results.simulate("nsga3-1/0")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"design": {"spool": 1.0}}, "'spool' is no parameter"),
        ({"set": {"spool_radius": "9"}}, "no unit"),
        ({"set": {"centred_opening": 2.0}}, "above 0 and below 1"),
        ({"design": {}, "scenario": "hot"}, "the campaign has scenario"),
        ({"design": CAMPAIGN, "campaign": CAMPAIGN}, "given twice"),
    ],
)
def test_simulate_refuses_what_the_command_refuses(arguments, words):
    with pytest.raises(UsageError, match=words):
        divideropt.simulate(**arguments)


def test_a_notebook_shows_what_there_is(ran):
    results, _ = ran
    response = results.simulate(results.front()["design_id"].iloc[0])
    first, error, *_, last = repr(response).splitlines()
    assert first == "outcome: ok"
    assert error == f"steady_state_error: {response.quantities.loc['steady_state_error', 'value']:.6g} %"
    assert ".plot()" in last
    assert response._repr_html_().count("<tr") == len(response.quantities) + 2  # and a head of two rows
    assert "<b>" not in divideropt.open(results.folder)._repr_html_()
    assert "runs: nsga2-1, complex-1\n" in results._repr_html_()
    compared = divideropt.compare(results.folder)
    assert repr(compared) == str(compared)
    assert compared._repr_html_().startswith("<pre>After ")


def test_export_is_the_command(ran, tmp_path):
    results, _ = ran
    folder = results.export("csv", tmp_path / "tables")
    assert folder == tmp_path / "tables"
    again = divideropt.evaluate(folder / "fronts" / "combined.csv", results.campaign)
    front = results.front()
    for name in ("design_id", *results.variables, *results.objectives):
        assert again[name].tolist() == front[name].tolist()
    pd.testing.assert_frame_equal(divideropt.evaluate(front, results.campaign), again)
    parquet = divideropt.export(results.folder, "parquet", tmp_path / "parquet")
    assert len(pd.read_parquet(parquet / "evaluations.parquet")) == 88
    with pytest.raises(UsageError, match="is there already"):
        divideropt.export(results.folder, out=tmp_path / "tables")


def test_a_failed_design_is_a_value():
    response = divideropt.simulate({"spool_radius": "1e-40 m"})
    assert response.outcome == "no_equilibrium"
    assert response.text
    assert response.quantities["value"].isna().any()


def test_evaluate_takes_a_table_or_a_file(ran, tmp_path):
    results, _ = ran
    designs = results.front()[["design_id", *results.variables]].head(4)
    designs.to_csv(tmp_path / "d.csv", index=False)
    found = divideropt.evaluate(designs, results.campaign)
    pd.testing.assert_frame_equal(found, divideropt.evaluate(tmp_path / "d.csv", results.campaign))
    assert (
        found[results.objectives].to_numpy().tolist() == results.front()[results.objectives].head(4).values.tolist()
    )
    assert found.attrs["units"]["steady_state_error"] == "%"
    assert found.attrs["units"]["outcome"] == ""
    with pytest.raises(FileMistakes, match=r"designs:1:2: the column 'colour' is no parameter"):
        divideropt.evaluate(pd.DataFrame({"spool_radius": [0.008], "colour": [1]}))


def test_status_compare_and_report_are_the_commands(ran):
    results, _ = ran
    status = results.status()
    assert divideropt.status(results.folder) == status
    assert [run.evaluations for run in status.runs] == [48, 40]
    compared = divideropt.compare(results.folder, at=40)
    assert compared.data["evaluations"] == 40
    assert str(compared).startswith("After 40 evaluations of each run")
    assert compared.table["run"].tolist() == ["nsga2-1", "complex-1"]
    assert len(compared.plot().data) > 0
    text = results.report().read_bytes()
    assert results.report().read_bytes() == text
    with pytest.raises(UsageError, match="no store there"):
        divideropt.open("nowhere")


def test_a_study_gives_its_indices(ran):
    results, _ = ran
    study = divideropt.sensitivity(
        CAMPAIGN, "morris", samples=10, store=results.folder, study="two", workers=1, words=io.StringIO()
    )
    assert set(study.table["variable"]) >= set(results.variables)
    assert study.report.parent == study.folder == results.folder / "sensitivity" / "two"
    assert "morris" in study.text.lower() or "trajector" in study.text
    assert "trajectories" in repr(study)
    assert repr(study).endswith(f"report: {study.report}\n.table has the numbers, .plot() draws them")
    assert study._repr_html_().startswith("<pre>")
    figure = study.plot()
    assert len(figure.data) == len(results.objectives)  # a panel an objective
    assert set(figure.data[0].text) >= {"r", "ΔPt"}
    assert len(study.plot("settling_time").data) == 1
    with pytest.raises(UsageError, match="no numbers of 'setling_time'; did you mean settling_time"):
        study.plot("setling_time")
    sweep = divideropt.sensitivity(
        CAMPAIGN,
        parameters=["spool_radius=8 mm..9 mm"],
        samples=3,
        store=results.folder,
        workers=1,
        words=io.StringIO(),
    )
    assert sweep.table["spool_radius"].between(8e-3, 9e-3).all()
    assert sweep.table.attrs["units"]["spool_radius"] == "m"
    assert repr(sweep).startswith("3 designs, one parameter at a time\nreport: ")
    drawn = sweep.plot("source_pressure")
    lines = [trace for trace in drawn.data if trace.mode and "lines" in trace.mode]
    assert [len(trace.x) for trace in lines] == [3]
    assert drawn.layout.xaxis.title.text == "r [mm]"
    assert drawn.layout.yaxis.title.text == "source pressure Ps [MPa]"
    assert "steady state error" in str(sweep.plot().layout.yaxis.title.text)


def test_error_budget_is_a_table_with_an_outcome():
    budget = divideropt.error_budget(set={"spool_radius": "9 mm"})
    assert budget.attrs["outcome"] == "ok"
    assert len(budget) > 3


def test_the_campaign_of_results_is_as_resolved(ran, tmp_path):
    (tmp_path / "small.yaml").write_text(CAMPAIGN, encoding="utf-8")
    assert ran[0].campaign == load_campaign(tmp_path / "small.yaml")


def test_a_program_reads_what_run_and_verify_did(ran, tmp_path):
    results, _ = ran
    (tmp_path / "small.yaml").write_text(CAMPAIGN, encoding="utf-8")
    call = ["run", str(tmp_path / "small.yaml"), "--store", str(results.folder), "--json"]
    done = CliRunner().invoke(commands, call)
    said = json.loads(done.stdout)
    assert said["report"] == str(results.folder / "report.html")
    assert [(r["run"], r["evaluations"], r["reason"]) for r in said["runs"]] == [
        ("nsga2-1", 48, "budget"),
        ("complex-1", 40, "budget"),
    ]
    assert said["front"] == len(results.front())
    *_, last = done.stderr.splitlines()
    assert "nothing to do: 2 of 2 runs are done; front, verification and KKT residuals are as before" in done.stderr
    assert last == f"report: {results.folder / 'report.html'}"
    verified = json.loads(CliRunner().invoke(commands, ["verify", str(results.folder), "--json"]).stdout)
    points = pd.concat(results.front(name) for name in ("combined", "nsga2-1", "complex-1"))["design_id"].nunique()
    assert (verified["points"], verified["agree"], verified["deviate"]) == (points, points, 0)
    assert set(verified["largest"]) == set(results.objectives)


def test_more_seeds_are_run_and_what_is_done_is_named(ran, tmp_path):
    results, _ = ran
    words = io.StringIO()
    longer = CAMPAIGN.replace("generations: 4, seeds: [1]", "generations: 4, seeds: [1, 2]")
    folder = tmp_path / "longer"
    shutil.copytree(results.folder, folder)
    more = divideropt.run(longer, folder, words=words)
    assert words.getvalue().startswith(
        "done before, and only compared with their logs: 2 of 3 runs (nsga2-1, complex-1)\n"
    )
    alone = divideropt.run(longer, tmp_path / "alone", words=io.StringIO())
    marks = [c for c in more.front().columns if c == "verified" or c.startswith("deviation_")]
    pd.testing.assert_frame_equal(
        more.front().drop(columns=marks), alone.front().drop(columns=marks), check_exact=True
    )
