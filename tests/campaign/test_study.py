"""A sensitivity study: what it makes of a campaign, and its store."""

import io
from pathlib import Path

import pandas as pd
import pytest

from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.load import default_campaign, load_campaign, parse_campaign
from divideropt.campaign.plan import build_problem, plan_runs
from divideropt.campaign.study import Asked, check_home, run_study, study_of, study_store
from divideropt.errors import FileMistakes, StoreError, UsageError
from divideropt.models.divider.study import THESIS_RANGES
from divideropt.store import Store

TOY = """
name: toy
model: {kind: "toy_model:Toy", set: {x3: 0.25}}
variables: {x1: [0, 1], x2: [0, 1]}
objectives: {f1: {goal: 0.2}, f2: {goal: 2, weight: 2}}
strategies: {nsga2: {population: 8, generations: 2}}
sensitivity: {sobol: {samples: 16}, morris: {trajectories: 10}, oat: {points: 5}, seed: 3}
parallel: {workers: 1}
"""


@pytest.fixture(name="toy")
def _toy():
    return parse_campaign(TOY)


def evaluations(store):
    parts = sorted((store.folder / "evaluations").glob("*/*.parquet"))
    return pd.concat([pd.read_parquet(part) for part in parts], ignore_index=True)


def test_the_dividers_sweeps_are_those_of_the_thesis():
    study = study_of(default_campaign(), Asked("oat"))
    assert study.variables == THESIS_RANGES
    (run,) = plan_runs(study)
    assert (run.name, run.budget) == ("oat-1", 1000)
    assert build_problem(study).fixed["radial_clearance"] == 3e-6  # from where the others are swept


def test_the_other_methods_take_the_campaigns_variables():
    campaign = default_campaign()
    study = study_of(campaign, Asked("sobol"))
    assert study.variables == campaign.variables
    assert study.objectives == campaign.objectives
    assert plan_runs(study)[0].budget == 4096 * 12
    assert plan_runs(study_of(campaign, Asked("sobol", alone=True)))[0].budget == 4096 * 7


def test_what_the_campaign_asks_for_is_done(toy):
    study = study_of(toy, Asked("sobol"))
    (run,) = plan_runs(study)
    assert (run.name, run.seed, run.budget) == ("sobol-3", 3, 16 * 6)
    assert study_of(toy, Asked("oat")).variables == toy.variables  # a model of one's own has no thesis
    assert parse_campaign(dump_campaign(toy)) == toy
    assert parse_campaign(dump_campaign(study)) == study


def test_parameters_are_chosen_with_or_without_a_range(toy):
    study = study_of(toy, Asked("morris", ("x1", "x3=0.1..0.6"), 20))
    assert study.variables == {"x1": (0.0, 1.0), "x3": (0.1, 0.6)}
    assert plan_runs(study)[0].budget == 60
    divider = study_of(default_campaign(), Asked("oat", ("stem_ratio=0.1..0.6", "spool_radius = 8 mm..20 mm")))
    assert divider.variables == {"stem_ratio": (0.1, 0.6), "spool_radius": (0.008, 0.02)}


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (Asked("oat", ("stem_rato=0.1..0.6",)), "did you mean stem_ratio"),
        (Asked("oat", ("stem_ratio",)), "write --parameter 'stem_ratio=LOWER..UPPER', around 0.3"),
        (Asked("oat", ("stem_ratio=0.1",)), "'0.1' is not a range"),
        (Asked("oat", ("stem_ratio=0.6..0.1",)), "is not below the upper"),
        (Asked("oat", ("spool_radius=8..20",)), "8 has no unit; write 8 m"),
        (Asked("oat", alone=True), "--no-second-order is of method sobol, not oat"),
        (Asked("sobol", (), 1000), "--samples 1000: 1000 is no power of two"),
        (Asked("sobol", (), 2**21), "--samples 2097152: 2097152 is too large; the most permitted is 1048576"),
        (Asked("morris", (), 5), "--samples 5: 5 is too small; the least permitted is 10"),
        (Asked("oat", ("spool_radius=",)), "--parameter spool_radius=: '' is not a range; write NAME=LOWER..UPPER"),
        (Asked("oat", ("spool_radius", "spool_radius=8 mm..9 mm")), "spool_radius is named a second time"),
    ],
)
def test_a_wrong_wish_is_refused_with_a_remedy(asked, words):
    with pytest.raises(UsageError, match=words):
        study_of(default_campaign(), asked)


def test_a_range_without_room_for_a_sweep_is_refused():
    narrow = parse_campaign(TOY.replace("x1: [0, 1]", "x1: [0.5, 0.5000000000000002]"))
    with pytest.raises(UsageError, match=r"^x1: between 0\.5 and 0\.5000000000000002 there are no 5 different"):
        study_of(narrow, Asked("oat"))
    assert study_of(narrow, Asked("oat", ("x2",))).variables == {"x2": (0.0, 1.0)}


def test_what_a_scenario_sets_cannot_be_studied():
    text = (Path(__file__).parents[2] / "campaigns" / "duty.yaml").read_text(encoding="utf-8")
    campaign = parse_campaign(text)
    for wish in ("kinematic_viscosity", "kinematic_viscosity=15 mm^2/s..66 mm^2/s"):
        with pytest.raises(UsageError, match=r"^--parameter kinematic_viscosity: scenario quarter_cold_up_1 sets it"):
            study_of(campaign, Asked("oat", (wish,)))
    with pytest.raises(FileMistakes, match="kinematic_viscosity is studied, which no scenario can set"):
        parse_campaign(text + "sensitivity: {parameters: {kinematic_viscosity: [15 mm^2/s, 66 mm^2/s]}}\n")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("sensitivity: {sobol: {samples: 100}}", "sensitivity.sobol.samples: 100 is no power of two"),
        ("sensitivity: {sobol: {sample: 128}}", "did you mean samples"),
        ("sensitivity: {sobol: 128}", "128 is not a mapping"),
        ("sensitivity: {parameters: {x1: [1, 0]}}", "sensitivity.parameters.x1: the lower bound"),
        ("sensitivity: {seed: -1}", "sensitivity.seed: -1 is too small"),
        ("sensitivity: {morris: {levels: 5}}", "sensitivity.morris.levels: 5 is odd"),
    ],
)
def test_mistakes_in_the_section_are_said_in_their_place(line, words):
    text = TOY.replace(next(row for row in TOY.splitlines() if row.startswith("sensitivity")), line)
    with pytest.raises(FileMistakes, match=r"campaign:7:\d+: ") as refused:
        parse_campaign(text)
    assert words in str(refused.value)


def test_only_a_study_may_vary_what_is_set():
    text = TOY.replace("{x1: [0, 1], x2", "{x3: [0, 1], x2")
    with pytest.raises(FileMistakes, match=r"x3 is in model\.set too"):
        parse_campaign(text)
    study = parse_campaign(text.replace("nsga2: {population: 8, generations: 2}", "oat: {points: 3}"))
    assert build_problem(study).fixed["x3"] == 0.25


def test_a_study_has_a_store_in_the_campaigns_and_goes_on_with_more_samples(toy, tmp_path):
    store = study_store(Store(tmp_path / "toy"), "sobol")
    assert store.folder == tmp_path / "toy" / "sensitivity" / "sobol"
    run_study(study_of(toy, Asked("sobol")), store, None, io.StringIO(), "again")
    few = evaluations(store)
    assert len(few) == 96
    run_study(study_of(toy, Asked("sobol", (), 64)), store, 2, io.StringIO(), "again")
    many = evaluations(store)
    assert len(many) == 384
    pd.testing.assert_frame_equal(many.iloc[:96], few, check_exact=True)
    anew = study_store(Store(tmp_path / "other"), "sobol")
    run_study(study_of(toy, Asked("sobol", (), 64)), anew, None, io.StringIO(), "again")
    pd.testing.assert_frame_equal(
        evaluations(anew).drop(columns="batch"), many.drop(columns="batch"), check_exact=True
    )
    with pytest.raises(StoreError, match=r"samples: 64 in the store, 16 in the campaign"):
        run_study(study_of(toy, Asked("sobol")), store, None, io.StringIO(), "again")
    assert [s.folder.name for s in Store(tmp_path / "toy").studies()] == ["sobol"]


def test_a_study_may_be_there_before_its_campaign_is_run_anew(toy, tmp_path):
    store = Store(tmp_path / "toy")
    run_study(study_of(toy, Asked("oat")), study_store(store, "oat"), None, io.StringIO(), "again")
    assert store.move_aside() is None
    (tmp_path / "toy" / "letter.txt").write_text("not ours")
    with pytest.raises(UsageError, match="not a store"):
        store.move_aside()


def test_what_is_uncertain_or_taken_over_scenarios_is_studied_as_it_is():
    folder = Path(__file__).parents[2] / "campaigns"
    robust = study_of(load_campaign(folder / "robust.yaml"), Asked("sobol"))
    assert robust.uncertainty is None
    assert set(robust.objectives) == {"steady_state_error", "dynamic_error", "source_pressure"}
    assert "failed_share" not in robust.constraints
    duty = load_campaign(folder / "duty.yaml")
    study = study_of(duty, Asked("oat"))
    assert study.objectives == duty.objectives  # over the same scenarios
    assert set(THESIS_RANGES) - set(study.variables) == {"kinematic_viscosity"}  # the scenarios have their own


def test_a_study_is_not_put_into_another_campaigns_store(toy, tmp_path):
    home = Store(tmp_path / "toy")
    check_home(home, toy)
    home.write_campaign(dump_campaign(toy))
    check_home(home, toy)
    check_home(home, parse_campaign(TOY.replace("generations: 2", "generations: 9")))
    with pytest.raises(StoreError, match=r"belongs to another campaign:\n  objectives\.f1\.goal: 0\.2 in the store"):
        check_home(home, parse_campaign(TOY.replace("goal: 0.2", "goal: 0.3")))
    home.campaign_path.write_text("name: toy")
    with pytest.raises(StoreError, match="damaged"):
        check_home(home, toy)


def test_a_folders_name_is_checked(tmp_path):
    with pytest.raises(UsageError, match=r"--study '\.\./x' cannot name a folder"):
        study_store(Store(tmp_path), "../x")
    with pytest.raises(UsageError, match="--study '' cannot name a folder"):
        study_store(Store(tmp_path), "")
    file = tmp_path / "file"
    file.touch()
    with pytest.raises(UsageError, match="a file, not a folder; name another --store"):
        study_store(Store(file), "oat")
