"""Terminations in a campaign: read, refused, kept by runs that are stopped and go on, changed, shown."""

import io
import json
import os
import shutil
import signal
import subprocess
import sys

import jsonschema
import pytest

from divideropt.campaign.dump import campaign_schema, dump_campaign
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.campaign.status import read_status
from divideropt.errors import DamagedFileError, FileMistakes, StoreError
from divideropt.report.data import read_report
from divideropt.report.tables import runs_table
from divideropt.store import Store
from stores import assert_same, logs

TEXT = """
name: toy
model: {kind: "toy_model:Toy"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 4}}
constraints: {spare: {min: 0 m}}
reference_point: {f1: 1, f2: 20}
strategies:
  nsga2: {population: 12, generations: 100, termination: {stagnation: {window: 200, gain: 1 %}}}
  genetic: {population: 10, generations: 40, termination: {goals: true}}
  complex: {points: 6, evaluations: 60, seeds: [3]}
verification: {sample: 0}
parallel: {workers: 1, backend: sequential}
"""

ENDS = {"nsga2-1": "stagnation", "genetic-1": "goals", "complex-3": "budget"}


def run(folder, text=TEXT):
    words = io.StringIO()
    Runner(parse_campaign(text), folder, 1, words).run()
    return words.getvalue()


@pytest.fixture(scope="module", name="whole")
def _whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "store"
    run(folder)
    return folder


def test_each_run_ends_for_its_reason_and_says_so(whole):
    status = {item.run: item for item in read_status(Store(whole)).runs}
    assert {name: item.reason for name, item in status.items()} == ENDS
    assert status["nsga2-1"].ending == "the hypervolume gained less than 1 % in 200 evaluations"
    assert 200 < status["nsga2-1"].evaluations < 1200
    design = status["genetic-1"].ending.split()[0]
    log = logs(whole)["genetic-1"].set_index("design_id")
    reached = log[(log.outcome == "ok") & (log.spare >= 0) & (log.f1 <= 0.2) & (log.f2.abs() <= 4)]
    assert reached.index[0] == design
    assert len(log) - 10 <= list(log.index).index(design) < len(log) < 400
    table = runs_table(read_report(Store(whole)))
    assert table.headings[-1].words == "ended"
    assert [row.cells[-1].text for row in table.rows] == [item.ending for item in status.values()]


def test_progress_says_why_a_run_ended(tmp_path):
    words = run(tmp_path / "store")
    assert "(done: the hypervolume gained less than 1 % in 200 evaluations)" in words
    assert "60 of 60 evaluations (done)" in words


@pytest.mark.parametrize("kept", [0, 1, 3])
def test_a_run_that_lost_its_tail_ends_at_the_same_batch(whole, tmp_path, kept, monkeypatch):
    folder = tmp_path / "store"
    monkeypatch.setattr("divideropt.store.parts.FLUSH_ROWS", 1)
    run(folder)
    shutil.rmtree(folder / "endings")
    for log in (folder / "evaluations").iterdir():
        for part in sorted(log.iterdir())[kept:]:
            part.unlink()
    assert all(item.reason is None for item in read_status(Store(folder)).runs)
    run(folder)
    assert_same(folder, whole)
    for record in sorted((whole / "endings").iterdir()):
        assert (folder / "endings" / record.name).read_bytes() == record.read_bytes()


@pytest.mark.parametrize(
    "change",
    [
        ("gain: 1 %", "gain: 0.1 %"),
        ("window: 200", "window: 400"),
        (", termination: {stagnation: {window: 200, gain: 1 %}}", ""),
    ],
)
def test_a_loosened_or_deleted_termination_lets_the_run_go_on(whole, tmp_path, change):
    folder, text = tmp_path / "store", TEXT.replace(*change)
    shutil.copytree(whole, folder)
    before = logs(folder)["nsga2-1"]
    run(folder, text)
    after = logs(folder)["nsga2-1"]
    assert len(after) > len(before)
    assert after.design_id[: len(before)].tolist() == before.design_id.tolist()
    run(tmp_path / "anew", text)
    assert_same(folder, tmp_path / "anew")
    assert read_status(Store(folder)).runs[0].evaluations == len(after)


def test_a_tightened_termination_is_refused_where_the_log_goes_on_and_changes_nothing(whole, tmp_path):
    folder = tmp_path / "store"
    shutil.copytree(whole, folder)
    campaign = (folder / "campaign.yaml").read_bytes()
    with pytest.raises(StoreError) as refused:
        run(folder, TEXT.replace("window: 200", "window: 40"))
    said = str(refused.value)
    assert "run nsga2-1 has gone on after" in said
    assert "the hypervolume gained less than 1 % in 40 evaluations" in said
    assert "loosen or delete strategies.nsga2.termination" in said
    assert (folder / "campaign.yaml").read_bytes() == campaign
    run(folder)
    assert_same(folder, whole)


def test_a_termination_by_which_the_log_ends_where_it_does_is_accepted(whole, tmp_path):
    folder = tmp_path / "store"
    shutil.copytree(whole, folder)
    run(folder, TEXT.replace("gain: 1 %", "gain: 1.001 %"))
    assert_same(folder, whole)
    assert read_status(Store(folder)).runs[0].ending.startswith("the hypervolume gained less than 1.001 %")


def test_a_record_counts_only_for_what_was_asked_for_and_logged(whole, tmp_path):
    folder = tmp_path / "store"
    shutil.copytree(whole, folder)
    store = Store(folder)
    with store.writing():
        store.write_campaign(dump_campaign(parse_campaign(TEXT.replace("evaluations: 60", "evaluations: 90"))))
    assert [item.reason for item in read_status(store).runs] == ["stagnation", "goals", None]
    shutil.rmtree(folder / "evaluations" / "genetic-1")
    assert [item.reason for item in read_status(store).runs] == ["stagnation", None, None]


def test_a_larger_budget_does_not_wake_a_run_that_a_rule_ended(whole, tmp_path):
    folder = tmp_path / "store"
    shutil.copytree(whole, folder)
    run(folder, TEXT.replace("generations: 100", "generations: 200").replace("evaluations: 60", "evaluations: 90"))
    status = read_status(Store(folder)).runs
    assert [item.reason for item in status] == ["stagnation", "goals", "budget"]
    assert (len(logs(folder)["nsga2-1"]), status[2].evaluations) == (len(logs(whole)["nsga2-1"]), 90)


DEADLY = """
import signal
from pathlib import Path
from toy_model import Toy

class Once(Toy):
    \"\"\"Kills its process in the middle of a run, unless the file is there.\"\"\"

    def __init__(self, file):
        super().__init__()
        self.file, self.count = Path(file), 0

    def evaluate(self, designs):
        self.count += len(designs)
        if self.count > 150 and not self.file.exists():
            self.file.touch()
            signal.raise_signal(signal.SIGKILL)
        return super().evaluate(designs)
"""


def test_a_run_that_is_killed_half_way_ends_at_the_same_batch(whole, tmp_path):
    (tmp_path / "deadly_toy.py").write_text(DEADLY)
    model = json.dumps({"kind": "deadly_toy:Once", "options": {"file": str(tmp_path / "died")}})
    text = TEXT.replace('{kind: "toy_model:Toy"}', model)
    (tmp_path / "toy.yaml").write_text(text)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *filter(None, sys.path)])}
    script = "from divideropt.store import parts; parts.FLUSH_ROWS = 1; from divideropt.cli import main; main()"
    command = [sys.executable, "-c", script, "run", str(tmp_path / "toy.yaml"), "--store", str(tmp_path / "store")]
    done, rows = [], []
    for _ in range(2):
        done.append(subprocess.run(command, env=environment, capture_output=True, check=False).returncode)
        rows.append(len(logs(tmp_path / "store")["nsga2-1"]))
    assert done == [-signal.SIGKILL, 0]
    assert 0 < rows[0] < rows[1]
    assert_same(tmp_path / "store", whole)
    for record in sorted((whole / "endings").iterdir()):
        assert (tmp_path / "store" / "endings" / record.name).read_bytes() == record.read_bytes()


def test_a_damaged_record_is_refused_and_made_again(whole, tmp_path):
    folder = tmp_path / "store"
    shutil.copytree(whole, folder)
    path = folder / "endings" / "nsga2-1.json"
    path.write_text(path.read_text().replace("stagnation", "budget"))
    with pytest.raises(DamagedFileError, match=r"nsga2-1\.json: damaged"):
        read_status(Store(folder))
    run(folder)
    assert path.read_bytes() == (whole / "endings" / "nsga2-1.json").read_bytes()


def test_it_is_read_written_and_in_the_schema():
    campaign = parse_campaign(TEXT)
    assert campaign.strategies[0].termination.stagnation.window == 200
    assert parse_campaign(dump_campaign(campaign)) == campaign
    rules = {"goals": True, "stagnation": {"window": 200, "gain": "1 %"}}
    schema = campaign_schema()
    nsga2 = {**schema, **schema["properties"]["strategies"]["properties"]["nsga2"]}
    nsga2 = {key: nsga2[key] for key in ("$defs", "properties", "additionalProperties", "type") if key in nsga2}
    jsonschema.validate({"termination": rules}, nsga2)
    jsonschema.validate({"termination": None}, nsga2)
    for wrong in ({"goal": True}, {"stagnation": {"window": 200}}, {"stagnation": {"window": 2, "gain": "1 %"}}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({"termination": wrong}, nsga2)
    json.dumps(schema)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("window: 200", "window: 5"), "termination.stagnation.window: 5 is too small; the least permitted is 10"),
        (("window: 200", "window: 1200"), "1200 is too large for a budget of 1200 evaluations"),
        (("window: 200, ", ""), "'window' is missing; add it"),
        (("gain: 1 %", "gain: 1"), "1 has no unit; write 1 %"),
        (("gain: 1 %", "gain: 0 %"), "out of range"),
        (("gain: 1 %", "gain: 101 %"), "out of range"),
        (("goals: true", "goals: yes"), "termination.goals: 'yes' is neither true nor false"),
        (("goals: true", "goals: false"), "there is no rule here; write goals: true or stagnation: {…}"),
        (("goals: true", "goal: true"), "the key 'goal' is not known; did you mean goals?"),
        (("{goals: true}", "soon"), "'soon' is not a mapping"),
        (("reference_point: {f1: 1, f2: 20}\n", ""), "the campaign has no reference point"),
        (("f2: {goal: 4}", "f2: {}"), "f2 has no goal, which genetic is to reach (termination)"),
    ],
)
def test_mistakes_say_value_limit_and_remedy(change, said):
    assert change[0] in TEXT
    with pytest.raises(FileMistakes) as refused:
        parse_campaign(TEXT.replace(*change))
    assert said in str(refused.value)
