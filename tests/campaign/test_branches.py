"""`--branch`: where a log and the strategy part, a new run goes on from what they have in common."""

import io
import pickle
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner

import divideropt
from divideropt.campaign.export import export_store
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.campaign.status import read_status
from divideropt.cli import commands
from divideropt.errors import BatchDiffersError
from divideropt.report.data import read_report
from divideropt.store import Store
from divideropt.store.tables import worded

CAMPAIGN = """
name: toy
model: {kind: "toy_model:Toy"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2}}
constraints: {spare: {min: 0 m}}
reference_point: {f1: 1, f2: 20}
strategies:
  nsga2: {population: 12, generations: GENERATIONS, seeds: [1, 2]}
  complex: {points: 6, evaluations: 60, seeds: [1]}
parallel: {workers: 1, backend: sequential}
"""

SHORT, LONG = CAMPAIGN.replace("GENERATIONS", "5"), CAMPAIGN.replace("GENERATIONS", "8")


def run(store, text, **options):
    words = io.StringIO()
    done = Runner(parse_campaign(text), store, 1, words).run(**options)
    return done, words.getvalue()


@pytest.fixture(scope="module", name="made")
def _made(tmp_path_factory):
    """Stores of five and of eight generations, each made in one go."""
    folder = tmp_path_factory.mktemp("made")
    run(folder / "short", SHORT)
    run(folder / "long", LONG)
    return folder


@pytest.fixture(name="store")
def _store(made, tmp_path):
    return Path(shutil.copytree(made / "short", tmp_path / "toy"))


def tamper(store, run, batch):
    """Change the last bit of a variable in a batch of a log, as another processor may."""
    changed = 0
    for path in sorted((store / "evaluations" / run).glob("*.parquet")):
        table = pq.read_table(path)
        rows = np.flatnonzero(table["batch"].to_numpy() == batch)
        if len(rows):
            values = table["x1"].to_numpy().copy()
            values[rows[0]] = np.nextafter(values[rows[0]], 2.0)
            place = table.schema.get_field_index("x1")
            path.write_bytes(worded(table.set_column(place, table.schema.field("x1"), [values])))
            changed += 1
    assert changed == 1


def log(store, run):
    return pd.read_parquet(store / "evaluations" / run)


def bits(table):
    """What a run asked for and what came out, whatever the run is called."""
    values = [table[name] for name in table if name not in ("design_id", "run")]
    return [v.to_numpy().tobytes() if v.dtype.kind in "fi" else v.tolist() for v in values]


def files(folder):
    return {path: path.read_bytes() for path in folder.rglob("*.parquet")}


def test_without_it_the_run_stops_and_names_the_batch(store):
    tamper(store, "nsga2-1", 3)
    before = files(store / "evaluations")
    with pytest.raises(
        BatchDiffersError, match=r"run nsga2-1: batch 3 .*with the 3 batches before it.*--branch"
    ) as e:
        run(store, LONG)
    assert (e.value.exit_code, e.value.run, e.value.batch) == (4, "nsga2-1", 3)
    assert str(pickle.loads(pickle.dumps(e.value))) == str(e.value)  # as it comes out of a worker
    assert files(store / "evaluations" / "nsga2-1") == {
        path: content for path, content in before.items() if path.parent.name == "nsga2-1"
    }


def test_a_branch_begins_with_what_is_the_same_and_is_the_run_that_would_have_been(store, made):
    tamper(store, "nsga2-1", 3)
    origin = files(store / "evaluations" / "nsga2-1")
    done, words = run(store, LONG, branch=True)
    assert "nsga2-1: goes on as nsga2-1-branch-1, from its first 3 batches" in words
    assert files(store / "evaluations" / "nsga2-1") == origin
    branch = log(store, "nsga2-1-branch-1")
    assert branch["design_id"].tolist() == [f"nsga2-1-branch-1/{i}" for i in range(96)]
    assert bits(branch.head(36)) == bits(log(store, "nsga2-1").head(36))
    assert bits(branch) == bits(log(made / "long", "nsga2-1"))
    assert bits(log(store, "nsga2-2")) == bits(log(made / "long", "nsga2-2"))
    assert set(done.logs) == {"nsga2-1", "nsga2-1-branch-1", "nsga2-2", "complex-1"}
    assert not done.nothing_new


def test_afterwards_the_store_goes_on_as_any_other(store, made):
    tamper(store, "nsga2-1", 3)
    run(store, LONG, branch=True)
    before = files(store)
    done, words = run(store, LONG)
    assert done.nothing_new
    assert "nsga2-1-branch-1: 96 of 96 evaluations, 96 from the log (done)" in words
    assert files(store) == before
    longer = CAMPAIGN.replace("GENERATIONS", "9")
    run(store, longer)
    run(made.parent / "straight", longer)
    assert bits(log(store, "nsga2-1-branch-1")) == bits(log(made.parent / "straight", "nsga2-1"))
    assert len(log(store, "nsga2-1")) == 60


def test_fronts_status_report_and_tables_know_it(store):
    tamper(store, "nsga2-1", 3)
    run(store, LONG, branch=True)
    front = pd.read_parquet(store / "fronts" / "combined.parquet")
    assert len(front.drop_duplicates(["x1", "x2", "x3"])) == len(front)  # what both have, once
    assert (store / "fronts" / "nsga2-1-branch-1.parquet").exists()
    names = ["nsga2-1", "nsga2-1-branch-1", "nsga2-2", "complex-1"]
    status = read_status(Store(store))
    assert [r.run for r in status.runs] == names
    assert (status.runs[0].reason, status.runs[1].reason) == ("branched", "budget")
    words = "nsga2-1-branch-1 goes on from its first 3 batches, since batch 3 came out differently there"
    assert status.runs[0].ending == words
    report = read_report(Store(store))
    assert [(r.name, r.ending == words) for r in report.runs][:2] == [("nsga2-1", True), ("nsga2-1-branch-1", False)]
    assert report.comparison is not None
    assert [s.run for s in report.comparison.scores] == ["nsga2-1-branch-1", "nsga2-2", "complex-1"]
    assert {line.run for track in report.tracks for line in track.lines} == set(names[1:])
    assert divideropt.compare(store).table["run"].tolist() == ["nsga2-1-branch-1", "nsga2-2", "complex-1"]
    assert [r.shared for r in status.runs] == [0, 36, 0, 0]
    assert report.failing.designs == 60 + (96 - 36) + 96 + 60  # what both have, once
    assert sum(sum(run.own.values()) for run in report.runs) == report.failing.designs
    assert report.tried.considered + report.tried.failed == report.failing.designs
    said = CliRunner().invoke(commands, ["status", str(store)]).stdout
    assert "nsga2-1-branch-1: 96 of 96 evaluations (" in said
    assert "), the first 36 of them another run's; best" in said
    assert export_store(Store(store), "parquet").evaluations == 60 + 96 + 96 + 60
    assert len(divideropt.open(store).front("nsga2-1-branch-1")) > 0


def test_a_branch_may_branch_in_turn_and_may_have_nothing_in_common(store, made):
    tamper(store, "nsga2-1", 2)
    run(store, CAMPAIGN.replace("GENERATIONS", "6"), branch=True)
    tamper(store, "nsga2-1-branch-1", 0)
    _, words = run(store, LONG, branch=True)
    assert "nsga2-1-branch-1: goes on as nsga2-1-branch-2, from its first 0 batches" in words
    assert bits(log(store, "nsga2-1-branch-2")) == bits(log(made / "long", "nsga2-1"))
    assert run(store, LONG)[0].nothing_new


def test_a_run_that_is_done_needs_no_branch(store, made):
    tamper(store, "complex-1", 4)
    _, words = run(store, LONG, branch=True)
    assert "complex-1: done; left as it is, though batch 4 differs here" in words
    assert sorted(path.name for path in (store / "evaluations").iterdir()) == ["complex-1", "nsga2-1", "nsga2-2"]
    assert bits(log(store, "nsga2-1")) == bits(log(made / "long", "nsga2-1"))


def test_where_nothing_differs_nothing_branches(made, tmp_path):
    store = Path(shutil.copytree(made / "long", tmp_path / "toy"))
    before = files(store)
    assert run(store, LONG, branch=True)[0].nothing_new
    assert files(store) == before


def test_the_command_and_the_function_branch_too(store, tmp_path):
    tamper(store, "nsga2-2", 1)
    (tmp_path / "toy.yaml").write_text(LONG)
    call = ["run", str(tmp_path / "toy.yaml"), "--store", str(store)]
    assert isinstance(CliRunner().invoke(commands, call).exception, BatchDiffersError)
    done = CliRunner().invoke(commands, [*call, "--branch"])
    assert done.exit_code == 0, done.exception
    assert "nsga2-2: goes on as nsga2-2-branch-1, from its first 1 batches" in done.stderr
    tamper(store, "nsga2-2-branch-1", 5)
    results = divideropt.run(
        LONG.replace("generations: 8", "generations: 9"), store, branch=True, words=io.StringIO()
    )
    assert len(results.evaluations("nsga2-2-branch-2")) == 108
