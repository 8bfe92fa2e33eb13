"""A campaign's companion without scenarios: derived, run in a store of its own, stopped and gone on with."""

import io
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from divideropt.campaign.beside import both_sides
from divideropt.campaign.companion import run_campaign
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.interrupt import InterruptedRunError
from divideropt.campaign.load import parse_campaign, stored_campaign
from divideropt.campaign.nominal import nominal_campaign
from divideropt.campaign.plan import build_problem
from divideropt.campaign.status import read_status
from divideropt.campaign.verify import verify_store
from divideropt.errors import FileMistakes, NoFeasibleDesignError, StoreError, StoreInUseError
from divideropt.report import write_report
from divideropt.store import Store
from divideropt.store.parts import Parts
from stores import assert_same

TEXT = """\
name: robust
model:
  kind: divider
  scenarios:
    light: {load_pressures: [2 MPa, 2 MPa], step: {load: 2, to: 4 MPa}}
    turned: {spool_position: 0.35}
variables:
  spool_radius: [6 mm, 16 mm]
  groove_width: [0.6 mm, 2 mm]
  total_pressure_drop: [2 MPa, 10 MPa]
objectives:
  steady_state_error: {goal: 0.5 %, weight: 3, worst_of: [scenario, light, turned]}
  dynamic_error: {goal: 0.5 mL, worst_of: [scenario, light, turned]}
  light.source_pressure: {goal: 8 MPa}
constraints:
  source_pressure: {max: 30 MPa}
  stability_margin: {min: 0 1/s, worst_of: [scenario, light, turned]}
  turned.settling_time: {max: 0.5 s}
reference_point: {steady_state_error: 10 %, dynamic_error: 10 mL, light.source_pressure: 30 MPa}
strategies:
  nsga2: {population: 8, generations: 3, seeds: [1]}
nominal: true
verification: {sample: 0}
optimality: {points: 1}
parallel: {workers: 1, backend: sequential}
"""


def run(folder: Path, text: str = TEXT, workers: int = 1, fresh: bool = False):
    words = io.StringIO()
    done, companion = run_campaign(parse_campaign(text), folder, workers, words, "the line that goes on", fresh=fresh)
    return done, companion, words.getvalue()


def kept(folder: Path) -> pd.DataFrame:
    return pd.read_parquet(folder / "beside")


def assert_same_everywhere(one: Path, other: Path) -> None:
    for mine, its in ((one, other), (one / "nominal", other / "nominal")):
        assert_same(mine, its)
        for name in ("beside", "optimality", "verification"):
            pd.testing.assert_frame_equal(pd.read_parquet(mine / name), pd.read_parquet(its / name), check_exact=True)
        assert (mine / "campaign.yaml").read_bytes() == (its / "campaign.yaml").read_bytes()


@pytest.fixture(scope="module", name="whole")
def _whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("companion") / "store"
    run(folder)
    return folder


def test_the_companion_asks_for_plain_quantities_of_the_base_scenario():
    campaign = parse_campaign(TEXT)
    nominal = nominal_campaign(campaign)
    assert nominal.name == "robust-nominal"
    assert [(n, o.goal, o.weight, o.worst_of) for n, o in nominal.objectives.items()] == [
        ("steady_state_error", 0.5, 3.0, ()),
        ("dynamic_error", pytest.approx(5e-7), 1.0, ()),
    ]
    assert [(n, c.min, c.max) for n, c in nominal.constraints.items()] == [
        ("source_pressure", None, 30e6),
        ("stability_margin", 0.0, None),
    ]
    assert list(nominal.reference_point) == ["steady_state_error", "dynamic_error"]
    assert nominal.model.scenarios == {}
    assert not nominal.nominal
    for same in ("variables", "strategies", "verification", "optimality", "parallel"):
        assert getattr(nominal, same) == getattr(campaign, same)
    assert parse_campaign(dump_campaign(nominal)) == nominal
    assert [o.quantity.name for o in build_problem(nominal).objectives] == ["steady_state_error", "dynamic_error"]


def test_the_longest_name_has_a_companion_too():
    text = TEXT.replace("name: robust", f"name: {'n' * 64}")
    nominal = nominal_campaign(parse_campaign(text))
    assert nominal.name == "n" * 56 + "-nominal"
    assert parse_campaign(dump_campaign(nominal)) == nominal


UNCERTAIN = """\
name: uncertain
model: {kind: "toy_model:CheckedToy"}
variables: {x1: [0, 1], x2: [0, 1]}
objectives:
  f1: {goal: 0.2, statistic: p95}
  f2: {goal: 2, weight: 2, statistic: mean}
  failed_share: {goal: 1 %}
constraints:
  spare: {min: 0 m, statistic: p5}
strategies: {nsga2: {population: 8, generations: 4}}
uncertainty:
  samples: 8
  parameters: {x2: {factor: {uniform: [0.5, 1]}}, x3: {uniform: [0, 1]}}
nominal: true
"""


def test_the_companion_knows_nothing_of_uncertainty(tmp_path):
    campaign = parse_campaign(UNCERTAIN)
    nominal = nominal_campaign(campaign)
    assert nominal.uncertainty is None
    assert list(nominal.objectives) == ["f1", "f2"]
    assert parse_campaign(dump_campaign(nominal)) == nominal
    assert [c.quantity.name for c in build_problem(nominal).constraints] == ["spare"]
    _, companion, _ = run(tmp_path, UNCERTAIN)
    known = kept(tmp_path).set_index("design_id")
    assert companion.points == len(known)
    front = pd.read_parquet(tmp_path / "nominal" / "fronts" / "combined.parquet").set_index("design_id")
    assert known.f1.tolist() == front.f1.tolist()
    assert "p95.f1" not in front.columns
    assert kept(tmp_path / "nominal").columns.tolist() == [
        name for name in front.reset_index().columns if not name.startswith(("verified", "deviation", "kkt"))
    ]
    assert "whole campaign" in write_report(Store(tmp_path)).read_text(encoding="utf-8")


PLAIN = """\
name: plain
model: {kind: divider, scenarios: {light: {load_pressures: [2 MPa, 2 MPa]}}}
variables: {spool_radius: [6 mm, 16 mm]}
objectives: {OBJECTIVE}
strategies: {nsga2: {population: 8, generations: 2}}
nominal: true
"""


@pytest.mark.parametrize(
    ("objective", "sentence"),
    [
        ("dynamic_error: {goal: 1 mL}", "the companion would be this campaign again; delete `nominal`, or give"),
        ("dynamic_error: {worst_of: []}", "the companion would be this campaign again; delete `nominal`, or give"),
        ("dynamic_error: {worst_of: [scenario]}", "the companion would be this campaign again; delete `nominal`"),
        (
            "failed_share: {goal: 1 %}}\nuncertainty: {parameters: {density: {uniform: [800 kg/m^3, 900 kg/m^3]}}",
            "nothing is left for the companion to minimise; delete `nominal`",
        ),
        ("light.dynamic_error: {goal: 1 mL}", "nothing is left for the companion to minimise; delete `nominal`"),
    ],
)
def test_a_companion_that_would_say_nothing_is_a_mistake(objective, sentence):
    with pytest.raises(FileMistakes) as caught:
        parse_campaign(text := PLAIN.replace("OBJECTIVE", objective), "plain.yaml")
    assert str(caught.value).startswith(f"plain.yaml:{text.splitlines().index('nominal: true') + 1}:1: nominal: ")
    assert sentence in str(caught.value)


def test_the_worst_of_all_is_the_campaign_again_where_there_is_one_scenario():
    text = PLAIN.replace("OBJECTIVE", "dynamic_error: {worst_of: all}").replace(
        ", scenarios: {light: {load_pressures: [2 MPa, 2 MPa]}}", ""
    )
    with pytest.raises(FileMistakes, match="the companion would be this campaign again"):
        parse_campaign(text)


def test_nominal_is_yes_or_no():
    with pytest.raises(FileMistakes, match=r"campaign:22:10: nominal: "):
        parse_campaign(TEXT.replace("nominal: true", "nominal: maybe"))


def test_a_strategy_that_does_not_suit_the_companion_is_a_mistake():
    text = TEXT.replace(
        "nsga2: {population: 8, generations: 3, seeds: [1]}", "memetic: {population: 8, evaluations: 9}"
    )
    one = text.replace("  dynamic_error: {goal: 0.5 mL, worst_of: [scenario, light, turned]}\n", "")
    one = one.replace("dynamic_error: 10 mL, ", "")
    assert parse_campaign(text).nominal
    with pytest.raises(FileMistakes, match="the companion's: one objective has no front to cover"):
        parse_campaign(one)


def test_each_front_is_judged_as_the_other_is(whole):
    campaign = stored_campaign(Store(whole))
    own, nominal = both_sides(campaign, Store(whole))
    for side, other in ((own, nominal), (nominal, own)):
        front = other.front()
        known = kept(side.store.folder)
        assert known.design_id.tolist() == front["design_id"].to_pylist()
        again = side.problem.simulate(other.schema.evaluations(front).designs)
        for i, name in enumerate(side.problem.model.quantities):
            assert known[name].to_numpy(dtype=float).tobytes() == again.quantities[:, i].tobytes(), name
        assert known.outcome.tolist() == [str(v.outcome) for v in again.verdicts]


def test_the_base_scenario_is_the_same_in_both(whole):
    """What the companion minimises is the plain column of the campaign's tables."""
    front = pd.read_parquet(whole / "nominal" / "fronts" / "combined.parquet").set_index("design_id")
    known = kept(whole).set_index("design_id")
    ok = known.index[known.outcome == "ok"]
    assert len(ok)
    for name in ("steady_state_error", "dynamic_error", "source_pressure"):
        assert known.loc[ok, name].to_numpy().tobytes() == front.loc[ok, name].to_numpy().tobytes()
        assert (known.loc[ok, "worst.dynamic_error"].abs() >= known.loc[ok, "dynamic_error"].abs()).all()


def test_the_words_say_what_happens(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "store")
    done, companion, words = run(tmp_path / "store")
    points = len(kept(whole))
    assert (
        f"nominal: now the companion, without scenarios and uncertainty, in {tmp_path / 'store' / 'nominal'}" in words
    )
    assert (companion.points, companion.outcomes.front.points) == (points, points)
    assert 0 <= companion.feasible <= points
    assert done.front.points == len(pd.read_parquet(whole / "fronts" / "combined.parquet"))
    assert_same_everywhere(tmp_path / "store", whole)


PHASES = [
    pytest.param("evaluations/nsga2-1", 2, marks=pytest.mark.slow),
    ("nominal/evaluations/nsga2-1", 2),
    pytest.param("nominal/optimality", 1, marks=pytest.mark.slow),
    ("beside", 2),
    pytest.param("nominal/beside", 1, marks=pytest.mark.slow),
]
"""Folders of parts, and how many tables are appended there before the end comes; the default run has one a store."""


def begun(whole: Path, store: Path, folder: str) -> None:
    """Make a store whose next run begins with the phase that writes to a folder."""
    if folder.startswith("evaluations"):
        return
    shutil.copytree(whole, store)
    gone = ["nominal"] if folder.startswith("nominal") and not folder.endswith("beside") else ["nominal/beside"]
    for name in ("beside", *gone):
        shutil.rmtree(store / name)


def test_workers_change_no_byte(whole, tmp_path):
    begun(whole, tmp_path / "store", "nominal")
    text = TEXT.replace("parallel: {workers: 1, backend: sequential}", "parallel: {workers: 2, backend: loky}")
    run(tmp_path / "store", text, workers=2)
    for name in ("", "nominal"):
        assert_same(tmp_path / "store" / name, whole / name)
        pd.testing.assert_frame_equal(kept(tmp_path / "store" / name), kept(whole / name), check_exact=True)


@pytest.mark.parametrize(("folder", "at"), PHASES)
def test_a_signal_in_any_phase_stops_it_and_the_next_call_ends_with_the_same_bytes(
    whole, tmp_path, monkeypatch, folder, at
):
    store = tmp_path / "store"
    begun(whole, store, folder)
    with monkeypatch.context() as patch:
        append, seen = Parts.append, []

        def counted(self, table):
            append(self, table)
            if self._folder == store / folder:
                seen.append(table)
                if len(seen) == at:
                    signal.raise_signal(signal.SIGTERM)

        patch.setattr(Parts, "append", counted)
        patch.setattr("divideropt.store.parts.FLUSH_ROWS", 1)
        with pytest.raises(InterruptedRunError, match="the line that goes on"):
            run(store)
    assert not (store / "nominal" / "beside").exists() or folder.endswith("beside")
    run(store)
    assert_same_everywhere(store, whole)


DEADLY = """\
import os, signal, sys
from pathlib import Path
from divideropt.cli import commands
from divideropt.store import parts
folder, at, file, store = sys.argv[1:]
parts.FLUSH_ROWS = 1
append, seen = parts.Parts.append, []
def counted(self, table):
    append(self, table)
    if self._folder == Path(store) / folder:
        seen.append(table)
        if len(seen) == int(at):
            os.kill(os.getpid(), signal.SIGKILL)
parts.Parts.append = counted
commands.main(["run", file, "--store", store], standalone_mode=False)
"""


@pytest.mark.parametrize(("folder", "at"), PHASES)
def test_a_kill_in_any_phase_costs_nothing(whole, tmp_path, folder, at):
    file, store = tmp_path / "robust.yaml", tmp_path / "store"
    file.write_text(TEXT)
    begun(whole, store, folder)
    command = [sys.executable, "-c", DEADLY, folder, str(at), str(file), str(store)]
    done = subprocess.run(command, env=os.environ, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == -signal.SIGKILL, done.stderr
    read_status(Store(store))
    run(store)
    assert_same_everywhere(store, whole)


def test_it_may_be_asked_for_later_and_left_off_again(whole, tmp_path):
    store = tmp_path / "store"
    without = TEXT.replace("nominal: true\n", "")
    assert run(store, without)[1] is None
    assert not (store / "nominal").exists()
    run(store)
    assert_same_everywhere(store, whole)
    run(store, without)
    assert stored_campaign(Store(store)).nominal is False
    assert kept(store).equals(kept(whole))


def test_an_extended_campaign_extends_its_companion(whole, tmp_path):
    more = TEXT.replace("generations: 3", "generations: 4")
    store = tmp_path / "store"
    shutil.copytree(whole, store)
    run(store, more)
    assert len(pd.read_parquet(store / "nominal" / "evaluations" / "nsga2-1")) == 32
    front = pd.read_parquet(store / "nominal" / "fronts" / "combined.parquet")
    assert set(front.design_id) <= set(kept(store).design_id)
    assert kept(store).design_id.tolist()[: len(kept(whole))] == kept(whole).design_id.tolist()


def test_fresh_moves_the_companion_aside_with_its_campaign(whole, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(whole, store)
    _, _, words = run(store, fresh=True)
    aside = next(path for path in tmp_path.iterdir() if path.name.startswith("store.before-"))
    assert f"the old store is now {aside}" in words
    assert_same_everywhere(aside, whole)
    assert_same_everywhere(store, whole)


def test_fresh_leaves_a_companion_alone_that_somebody_writes_to(whole, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(whole, store)
    code = (
        "import sys; from pathlib import Path; from divideropt.store import Store\n"
        "with Store(Path(sys.argv[1])).writing(): print('held', flush=True); sys.stdin.read()"
    )
    command = [sys.executable, "-c", code, str(store / "nominal")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as holding:
        assert holding.stdout.readline() == "held\n"
        with pytest.raises(StoreInUseError, match=f"{store / 'nominal'}: another divideropt is writing"):
            run(store, fresh=True)
        holding.communicate()
    assert (store / "nominal" / "campaign.yaml").is_file()


def test_the_companions_store_is_a_store(whole, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(whole, store)
    nominal = Store(store / "nominal")
    status = read_status(nominal)
    assert (status.campaign, status.asks_nominal) == ("robust-nominal", False)
    tally = verify_store(nominal, 1, io.StringIO(), "")
    assert tally.agree + tally.deviate == tally.points == status.front
    assert "robust-nominal" in write_report(nominal).read_text(encoding="utf-8")
    run(store)
    assert len(pd.read_parquet(store / "nominal" / "verification")) == tally.points


def test_the_status_says_how_far_the_companion_is(whole, tmp_path):
    found = read_status(Store(whole))
    assert found.asks_nominal
    assert found.nominal.campaign == "robust-nominal"
    assert found.beside.points == found.beside.known == len(kept(whole))
    store = tmp_path / "store"
    shutil.copytree(whole, store)
    shutil.rmtree(store / "beside")
    found = read_status(Store(store))
    assert (found.beside.known, found.beside.feasible) == (0, 0)
    shutil.rmtree(store / "nominal" / "fronts")
    assert read_status(Store(store)).beside is None
    shutil.rmtree(store / "nominal")
    assert read_status(Store(store)).nominal is None


def test_damage_is_said_before_anything_is_simulated(whole, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(whole, store)
    part = min((store / "beside").iterdir())
    part.write_bytes(part.read_bytes()[:-9])
    more = TEXT.replace("generations: 3", "generations: 4")
    with pytest.raises(StoreError, match=r"beside/part-000000000\.parquet: damaged.*delete .*beside"):
        run(store, more)
    assert len(pd.read_parquet(store / "evaluations" / "nsga2-1")) == 24


def test_other_designs_than_the_fronts_are_refused(whole, tmp_path):
    store, other = tmp_path / "store", tmp_path / "other"
    shutil.copytree(whole, store)
    run(other, TEXT.replace("spool_radius: [6 mm, 16 mm]", "spool_radius: [7 mm, 15 mm]"))
    shutil.rmtree(store / "beside")
    shutil.copytree(other / "beside", store / "beside")
    with pytest.raises(StoreError, match="is another design than on the front; delete that folder"):
        run(store)


def test_a_companions_store_of_another_campaign_is_refused(whole, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(whole, store)
    nominal = Store(store / "nominal")
    nominal.write_campaign(nominal.read_campaign().replace("[1]", "[5]"))
    with pytest.raises(
        StoreError, match=r"nominal: this store belongs to another campaign:\s+strategies.nsga2.seeds"
    ):
        run(store)


def test_a_campaign_without_a_feasible_design_still_has_its_companion(tmp_path):
    """Under `turned` no valve settles in a microsecond; the companion is not asked for that."""
    text = TEXT.replace("turned.settling_time: {max: 0.5 s}", "turned.settling_time: {max: 1 us}")
    with pytest.raises(NoFeasibleDesignError, match=f"{tmp_path}: no design is feasible"):
        run(tmp_path, text)
    found = read_status(Store(tmp_path))
    assert found.front == 0
    assert found.nominal.front == found.beside.known > 0
    assert found.beside.feasible == 0


def test_a_companion_without_a_feasible_design_is_said_only(tmp_path):
    """The base scenario's load alone is at 15 MPa, which `light` never sees."""
    text = TEXT.replace("source_pressure: {max: 30 MPa}", "source_pressure: {max: 14 MPa, worst_of: [light]}")
    done, companion, words = run(tmp_path, text)
    assert done.front.points > 0
    assert (companion.outcomes, companion.points, companion.feasible) == (None, 0, 0)
    assert f"nominal: {tmp_path / 'nominal'}: no design is feasible" in words
    assert (
        kept(tmp_path / "nominal").design_id.tolist()
        == pd.read_parquet(tmp_path / "fronts" / "combined.parquet").design_id.tolist()
    )
    write_report(Store(tmp_path))
