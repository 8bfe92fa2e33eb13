"""The commands as a user calls them: data on standard output, words on standard error, exit codes."""

import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from divideropt.cli import main
from divideropt.models.divider import QUANTITIES

CAMPAIGN = """
name: small
model: {kind: divider, set: {radial_clearance: 3 um}}
variables:
  spool_radius: [6 mm, 16 mm]
  groove_width: [0.6 mm, 2 mm]
  total_pressure_drop: [2 MPa, 10 MPa]
objectives:
  steady_state_error: {goal: 0.5 %, weight: 3}
  dynamic_error: {goal: 0.5 mL, weight: 3}
  source_pressure: {goal: 18 MPa}
constraints: {source_pressure: {max: 30 MPa}, stop_clearance: {min: 0 mm}}
reference_point: {steady_state_error: 10 %, dynamic_error: 10 mL, source_pressure: 30 MPa}
strategies:
  nsga2: {population: 16, generations: GENERATIONS, seeds: [1]}
  complex: {points: 6, evaluations: EVALUATIONS, seeds: [1]}
verification: {sample: 0}
"""


ALONE = ("--workers", "1")
"""Without worker processes, whose beginning is half the work of a small campaign; the cells are the same."""


def call(*arguments, folder, **options):
    """Run the command as a process of its own."""
    command = [sys.executable, "-m", "divideropt", *map(str, arguments)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False, **options)


def call_here(arguments, folder, monkeypatch, capsys):
    """Run the command in this process, which is quicker, and return exit code, output and words."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", ["divideropt", *arguments])
    with pytest.raises(SystemExit) as left:
        main()
    return left.value.code, *capsys.readouterr()


def write_campaign(folder: Path, generations=4, evaluations=40) -> Path:
    path = folder / "small.yaml"
    text = CAMPAIGN.replace("GENERATIONS", str(generations)).replace("EVALUATIONS", str(evaluations))
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module", name="finished")
def _finished(tmp_path_factory):
    """A folder in which a small campaign was run, and what the command said."""
    folder = tmp_path_factory.mktemp("finished")
    write_campaign(folder)
    return folder, call("run", "small.yaml", folder=folder)


def test_run_writes_fronts_and_a_report_and_says_where(finished):
    folder, done = finished
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""
    assert done.stderr.splitlines()[-1] == "report: results/small/report.html"
    assert " front points, 0 deviate; largest deviation: steady_state_error " in done.stderr.splitlines()[-3]
    assert done.stderr.splitlines()[-2].startswith("KKT residual of ")
    store = folder / "results" / "small"
    front = pd.read_parquet(store / "fronts" / "combined.parquet")
    assert len(front) > 5
    assert (front.outcome == "ok").all()
    assert (front.verified == "yes").sum() >= 5
    assert set(front.verified) <= {"yes", "no"}
    assert set(QUANTITIES) < set(front.columns)
    assert "Traceback" not in done.stderr
    assert (store / "report.html").stat().st_size > 1e6


def test_status_says_what_is_done_and_best(finished):
    folder, _ = finished
    said = json.loads(call("status", "results/small", "--json", folder=folder).stdout)
    assert [(r["run"], r["evaluations"], r["budget"]) for r in said["runs"]] == [
        ("nsga2-1", 64, 64),
        ("complex-1", 40, 40),
    ]
    front = pd.read_parquet(folder / "results" / "small" / "fronts" / "combined.parquet")
    assert said["front"] == len(front)
    assert (said["verified"], said["deviating"]) == ((front.verified == "yes").sum(), 0)
    lam = pd.concat(
        [
            (front.steady_state_error - 0.5) / 0.5 * 3,
            (front.dynamic_error.abs() - 0.5e-6) / 0.5e-6 * 3,
            (front.source_pressure - 18e6) / 18e6,
        ],
        axis=1,
    ).max(axis=1)
    assert min(r["best"] for r in said["runs"]) == pytest.approx(lam.min(), rel=1e-12)
    words = call("status", "results/small", folder=folder).stdout
    assert "nsga2-1: 64 of 64 evaluations" in words
    assert [r["reason"] for r in said["runs"]] == ["budget", "budget"]
    assert "  ended: its budget of 64 evaluations is spent" in words
    assert f"{said['verified']} of them verified, 0 deviating" in words
    assert said["kkt"]["computed"] == (front.kkt == "computed").sum() > 0
    assert said["kkt"]["median"] == pytest.approx(front.kkt_residual.median(), rel=1e-12)
    assert f"KKT residual of {said['kkt']['computed']} front points: median" in words


def test_report_writes_it_again_the_same(finished):
    folder, _ = finished
    assert call("report", "results/small", "--out", "again.html", folder=folder).returncode == 0
    assert (folder / "again.html").read_bytes() == (folder / "results" / "small" / "report.html").read_bytes()


def test_verify_does_all_front_points_and_goes_on_after_a_kill_and_a_signal(finished, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(finished[0] / "results" / "small", store)
    kept = store / "verification"
    command = [sys.executable, "-m", "divideropt", "verify", "store"]
    for number, send, code in ((signal.SIGKILL, os.killpg, -9), (signal.SIGTERM, os.kill, 143)):
        before = len(list(kept.iterdir()))
        process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, start_new_session=True)
        wait_until(lambda count=before: len(list(kept.iterdir())) > count, "nothing was verified")
        send(process.pid, number)
        words = process.communicate(timeout=60)[1]
        assert process.returncode == code, words
    assert words.splitlines()[-1].strip() == "divideropt verify store"
    done = call("verify", "store", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    fronts = {p.stem: pd.read_parquet(p) for p in (store / "fronts").glob("*.parquet")}
    points = pd.concat(fronts.values()).drop_duplicates("design_id")
    assert (points.verified == "yes").all()
    assert points.deviation_dynamic_error.between(0.0, 0.01).all()
    results = pd.read_parquet(kept).set_index("design_id")
    assert results.index.is_unique
    assert set(results.index) == set(points.design_id)
    again, first = results.loc[points.design_id].dynamic_error.values, points.dynamic_error.values
    share = abs(first - again) / np.maximum(abs(again), 0.01 * 1e-6)
    assert share == pytest.approx(points.deviation_dynamic_error.values, rel=1e-9)
    last, where = done.stderr.splitlines()[-2:]
    assert where == "report: store/report.html"
    assert last.startswith(f"verified: {len(points)} of {len(points)} front points, 0 deviate; largest deviation: ")
    assert f"dynamic_error {share.max():.1e}" in last
    assert "Verified: " in (store / "report.html").read_text(encoding="utf-8")


def test_evaluate_keeps_order_and_identities_and_reports_failures_as_rows(tmp_path):
    (tmp_path / "d.csv").write_text(
        "design_id,spool_radius,fixed_drop_ratio,centred_opening\nb,0.008,0.5,0.5\nbroken,0.003,0.5,0.5\na,0.0133,0.886,0.421\n"
    )
    done = call("evaluate", "d.csv", "--out", "out.parquet", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    table = pd.read_parquet(tmp_path / "out.parquet")
    assert list(table.columns[:4]) == ["design_id", "spool_radius", "fixed_drop_ratio", "centred_opening"]
    assert list(table.columns[4:]) == [*QUANTITIES, "outcome", "outcome_text"]
    assert table.design_id.tolist() == ["b", "broken", "a"]
    assert table.outcome[0] == "ok"
    assert table.outcome[1] != "ok"
    assert table.outcome_text[1]
    plain = call("evaluate", "d.csv", folder=tmp_path).stdout.splitlines()
    assert plain[0].split(",") == list(table.columns)
    assert float(plain[1].split(",")[4]) == table.steady_state_error[0]


def test_evaluate_takes_what_is_missing_from_the_campaign(tmp_path):
    write_campaign(tmp_path)
    (tmp_path / "d.csv").write_text("spool_radius\n0.008\n")
    (tmp_path / "e.csv").write_text("spool_radius,radial_clearance\n0.008,3e-6\n")
    first, second = (
        pd.read_csv(_stdout(call("evaluate", name, "--campaign", "small.yaml", folder=tmp_path)))
        for name in ("d.csv", "e.csv")
    )
    pd.testing.assert_frame_equal(first, second.drop(columns="radial_clearance"))


def _stdout(done):
    assert done.returncode == 0, done.stderr
    return io.StringIO(done.stdout)


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("spool_radius,colour\n0.008,1\n", ["d.csv:1:2:", "'colour'", "spool_radius"]),
        ("spool_radius,spool_radius\n1,2\n", ["d.csv:1:2:", "second time"]),
        ("spool_radius,groove_width\n,0.001\n0.008,x\n", ["d.csv:2:1:", "empty", "d.csv:3:2:", "'x'"]),
        ("centred_opening\n1.5\nnan\n", ["d.csv:2:1:", "above 0 and below 1", "d.csv:3:1:"]),
        ("spool_radius,groove_width\n0.008\n", ["d.csv:2:1:", "1 cells, the header 2"]),
        ("", ["the file is empty"]),
        ('spool_radius,design_id\n0.009,"unclosed\n0.010,b\n', ["d.csv", "unexpected end of data"]),
        ("spool_radius\n0.008\n\n0.009\n", ["d.csv:3:1:", "empty"]),
        ("\nspool_radius\n0.008\n", ["d.csv:1:1:", "blank", "name the columns"]),
    ],
)
def test_a_bad_table_of_designs_is_refused_with_every_place(tmp_path, monkeypatch, capsys, text, places):
    (tmp_path / "d.csv").write_text(text)
    code, out, err = call_here(["evaluate", "d.csv"], tmp_path, monkeypatch, capsys)
    assert code == 2
    assert out == ""
    assert "Traceback" not in err
    for place in places:
        assert place in err


def test_simulate_gives_a_table_or_a_picture(tmp_path):
    done = call("simulate", "--set", "spool_radius=9 mm", folder=tmp_path)
    table = pd.read_csv(_stdout(done))
    assert table.columns[0] == "time"
    assert table.time.is_monotonic_increasing
    assert table.time.iloc[-1] == 1.0
    assert table.load_flow_2.iloc[0] == pytest.approx(5e-4, rel=1e-4)
    assert table.load_flow_1.iloc[-1] > table.load_flow_2.iloc[-1]
    assert done.stderr.startswith("outcome: ok")
    assert call("simulate", "--out", "r.html", folder=tmp_path).returncode == 0
    assert "<html" in (tmp_path / "r.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["simulate", "--set", "spool_radius=9"], "no unit"),
        (["simulate", "--set", "spool=9 mm"], "no parameter"),
        (["simulate", "--set", "spool_radius=1e300 m"], "too large to be computed with"),
        (["simulate", "--set", "spool_radius"], "NAME=VALUE"),
        (["simulate", "--set", "centred_opening=2"], "above 0 and below 1"),
        (["simulate", "--out", "r.txt"], ".csv, .parquet or .html"),
        (["run", "nowhere.yaml"], "no such file"),
        (["check", "nowhere.yaml"], "no such file"),
        (["status", "."], "no store there"),
        (["verify", "."], "no store there"),
        (["report", "nowhere"], "no store there"),
        (["evaluate", "nowhere.csv"], "no such file"),
        (["frobnicate"], "No such command"),
        (["evaluate", "d.csv", "--out", "d.csv"], "the file to be read"),
        (["evaluate", "d.csv", "--out", "nowhere/o.csv"], "no folder nowhere"),
        (["report", "x", "--out", "campaign.yaml"], "must end in .html"),
    ],
)
def test_a_wrong_call_ends_with_2_and_a_sentence(tmp_path, monkeypatch, capsys, arguments, words):
    (tmp_path / "d.csv").write_text("spool_radius\n0.008\n")
    code, out, err = call_here(arguments, tmp_path, monkeypatch, capsys)
    assert code == 2
    assert out == ""
    assert words in err
    assert "Traceback" not in err


def test_check_and_run_refuse_a_bad_campaign_with_every_place(tmp_path):
    path = write_campaign(tmp_path)
    text = path.read_text().replace("[6 mm, 16 mm]", "[16 mm, 6 mm]").replace("max: 30 MPa", "max: 30")
    path.write_text(text)
    for command in ("check", "run"):
        done = call(command, "small.yaml", folder=tmp_path)
        assert done.returncode == 2
        lines = done.stderr.splitlines()
        assert [line.split(" ")[0] for line in lines] == ["small.yaml:5:17:", "small.yaml:12:38:"]
    assert not (tmp_path / "results").exists()


def test_absurd_dimensions_are_an_outcome_not_a_traceback(tmp_path, monkeypatch, capsys):
    code, out, err = call_here(["simulate", "--set", "groove_width=1e40 m"], tmp_path, monkeypatch, capsys)
    assert code == 0
    assert out.count("\n") == 1
    assert "outcome: no_equilibrium" in err
    assert "Traceback" not in err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_standard_output_ends_with_74(tmp_path):
    command = [sys.executable, "-m", "divideropt", "schema"]
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False, timeout=60)
    assert done.returncode == 74
    assert "No space left" in done.stderr


def test_schema_is_json_and_knows_the_parameters(tmp_path):
    schema = json.loads(call("schema", folder=tmp_path).stdout)
    assert "spool_radius" in json.dumps(schema)


def test_help_imports_nothing_heavy(tmp_path):
    code = (
        "import sys, divideropt.cli; print([m for m in ('numpy', 'numba', 'pandas', 'plotly') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_no_feasible_design_ends_with_5_and_still_reports(tmp_path):
    path = write_campaign(tmp_path, generations=1, evaluations=6)
    path.write_text(path.read_text().replace("max: 30 MPa", "max: 1 MPa"))
    done = call("run", "small.yaml", folder=tmp_path)
    assert done.returncode == 5
    assert "no design is feasible" in done.stderr
    assert (tmp_path / "results" / "small" / "report.html").is_file()


def start(folder: Path) -> subprocess.Popen[bytes]:
    """Start a longer campaign in a process group of its own."""
    write_campaign(folder, generations=30, evaluations=300)
    command = [sys.executable, "-m", "divideropt", "run", "small.yaml"]
    with (folder / "words.txt").open("w", encoding="utf-8") as words:
        return subprocess.Popen(command, cwd=folder, stderr=words, start_new_session=True)


def words(folder: Path) -> str:
    """Return what the last started campaign said."""
    return (folder / "words.txt").read_text(encoding="utf-8")


def wait_for_parts(folder: Path, count: int) -> None:
    """Wait until the log has some parts."""
    log = folder / "results" / "small" / "evaluations"
    wait_until(lambda: len(list(log.glob("*/part-*.parquet"))) >= count, "the campaign logged nothing")


def wait_until(question: Callable[[], bool], complaint: str) -> None:
    """Wait until it is so."""
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        if question():
            return
        time.sleep(0.02)
    raise AssertionError(complaint)


@pytest.fixture(scope="module", name="uninterrupted")
def _uninterrupted(tmp_path_factory):
    folder = tmp_path_factory.mktemp("uninterrupted")
    write_campaign(folder, generations=30, evaluations=300)
    assert call("run", "small.yaml", *ALONE, folder=folder).returncode == 0
    return fronts(folder)


def fronts(folder: Path) -> dict[str, pd.DataFrame]:
    return {p.name: pd.read_parquet(p) for p in (folder / "results" / "small" / "fronts").glob("*.parquet")}


def assert_same_fronts(folder: Path, expected: dict[str, pd.DataFrame]) -> None:
    found = fronts(folder)
    assert set(found) == set(expected) == {"combined.parquet", "nsga2-1.parquet", "complex-1.parquet"}
    for name, front in expected.items():
        pd.testing.assert_frame_equal(found[name], front, check_exact=True)


@pytest.mark.parametrize("whole_group", [True, False])
def test_a_killed_campaign_goes_on_to_the_same_cells(tmp_path, uninterrupted, whole_group):
    process = start(tmp_path)
    for parts in (1, 2):
        wait_for_parts(tmp_path, parts)
        (os.killpg if whole_group else os.kill)(process.pid, signal.SIGKILL)
        process.wait()
        process = start(tmp_path)
    assert process.wait(timeout=200) == 0, words(tmp_path)
    assert_same_fronts(tmp_path, uninterrupted)


@pytest.mark.parametrize(
    ("number", "send", "code"),
    [(signal.SIGINT, os.killpg, 130), (signal.SIGTERM, os.kill, 143), (signal.SIGTERM, os.killpg, 143)],
)
def test_a_signal_stops_within_seconds_and_names_the_line_that_goes_on(tmp_path, uninterrupted, number, send, code):
    process = start(tmp_path)
    wait_for_parts(tmp_path, 1)
    asked = time.monotonic()
    send(process.pid, number)
    assert process.wait(timeout=60) == code
    assert time.monotonic() - asked < 5.0
    assert words(tmp_path).splitlines()[-1].strip() == "divideropt run small.yaml"
    assert call("run", "small.yaml", *ALONE, folder=tmp_path).returncode == 0
    assert_same_fronts(tmp_path, uninterrupted)


def test_a_store_in_use_ends_with_3(tmp_path):
    process = start(tmp_path)
    wait_for_parts(tmp_path, 1)
    done = call("run", "small.yaml", folder=tmp_path)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert done.returncode == 3
    assert "another divideropt is writing" in done.stderr


def test_a_store_of_another_campaign_ends_with_4(finished):
    folder, _ = finished
    other = folder / "other.yaml"
    other.write_text((folder / "small.yaml").read_text().replace("16 mm", "15 mm"))
    done = call("run", "other.yaml", folder=folder)
    assert done.returncode == 4
    assert "variables.spool_radius" in done.stderr
