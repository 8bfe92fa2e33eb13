"""The page of claims agrees with itself, with fresh runs and with the author's code; its criteria can fail."""

import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from claims import author, criteria, grooves, pilot_line, radius, resolution, trends
from claims.experiment import ASSUMED, prototype
from claims.judgement import Answer, Judgement, all_of
from claims.page import write_page
from claims.runs import VARIANTS, Runs, Sweep

from divideropt.models.divider import FORMULATIONS, parameter_set, rig
from divideropt.models.divider.geometry import derive_geometry
from divideropt.models.divider.ideal import flow_ratio

PAGE = (Path(__file__).parents[2] / "docs" / "model" / "claims.md").read_text(encoding="utf-8")
SECTION_A, SECTION_B = PAGE.split("## A. ")[1].split("## B. ")
NAMES = [str(variant) for variant in VARIANTS]


@pytest.fixture(scope="module")
def runs():
    return {str(variant): Runs(variant) for variant in VARIANTS}


def block(quotation):
    """What the page has from a statement to the next one."""
    return PAGE.split(f"“{quotation}”")[1].split("“")[0]


def curve(values, ok=None):
    """A sweep over 0 to 1 with these values of the error."""
    found = np.array(values, dtype=float)
    alright = np.ones(len(found), dtype=bool) if ok is None else np.array(ok)
    return Sweep(np.linspace(0, 1, len(found)), {"steady_state_error": found}, alright, "")


@pytest.mark.parametrize(("section", "names"), [(SECTION_A, NAMES), (SECTION_B, list(FORMULATIONS))])
def test_its_counts_are_those_of_its_answers(section, names):
    statements = len(re.findall(r"^\*\*[AB]\d+\.\*\*", section, re.MULTILINE))
    for name in names:
        answers = Counter(re.findall(rf"^\| {name} \| \*\*([a-z ]+)\*\*", section, re.MULTILINE))
        silent = statements - sum(answers.values())  # no table: not judged
        counts = [answers["yes"], answers["in part"], answers["no"], answers["not judged"] + silent, statements]
        assert f"| {name} | {' | '.join(map(str, counts))} |" in PAGE


@pytest.mark.parametrize("name", ["conservative", "listing"])
def test_its_clearance_is_what_runs_say_now(runs, name):
    for statement in grooves.CLEARANCE.statements[:5]:
        assert f"| {name} | {statement.judged(runs[name])} |" in block(statement.quotation)


def test_its_loss_of_control_is_what_runs_say_now(runs):
    lost, unstable = radius.CHAPTER.statements[8:10]
    for name in NAMES:
        for statement in (lost, unstable):
            assert f"| {name} | {statement.judged(runs[name])} |" in block(statement.quotation)


def test_its_experiment_is_what_runs_say_now():
    for name in FORMULATIONS:
        drops = trends.assumed(name).drops
        errors = ", ".join(f"{point.error:.2f}" for point in drops)
        volumes = ", ".join(f"{1e6 * point.dynamic:.2f}" for point in drops)
        assert f"| as assumed | {errors} | {volumes} |" in PAGE.split(f"`{name}`:")[1]


@pytest.mark.slow
def test_it_is_what_its_command_writes():
    assert write_page() == PAGE


def test_our_listing_repeats_the_authors_sweeps(runs):
    for found in author.nearness(runs["listing, cold"], limit=4):
        assert found.compared >= 3
        assert found.off["flow_difference"][1] < 1e-4
        assert found.off["source_pressure"][1] < 1e-5
        assert found.off["dynamic_error"][1] < 5e-3  # his are sums over 2000 samples
        assert found.off["settling_time"][1] < 5e-3


@pytest.mark.parametrize(
    ("values", "answer"),
    [
        ([1, 2, 3, 4], Answer.YES),
        ([1, 2, 1.99, 4], Answer.YES),  # a step back within the noise
        ([1, 3, 2, 4], Answer.IN_PART),
        ([3, 4, 5, 2], Answer.IN_PART),  # over two thirds of the range
        ([5, 6, 3, 2], Answer.NO),
        ([4, 3, 2, 1], Answer.NO),
        ([100, 100.5, 101, 101.5], Answer.NO),  # flat
        ([-1, -2, -3, -4], Answer.YES),  # of the magnitude
    ],
)
def test_rises(values, answer):
    assert criteria.rises(curve(values), "steady_state_error").answer is answer
    assert criteria.falls(curve(values[::-1]), "steady_state_error").answer is answer


@pytest.mark.parametrize(
    ("last", "answer"), [(5.0, Answer.YES), (4.99, Answer.IN_PART), (4.41, Answer.IN_PART), (4.39, Answer.NO)]
)
def test_strong(last, answer):
    base = {"steady_state_error": 4.0}
    sweep = curve([4.0, last])
    opposite = {Answer.YES: Answer.NO, Answer.NO: Answer.YES}.get(answer, answer)
    assert criteria.strong(sweep, "steady_state_error", base).answer is answer
    assert criteria.small(sweep, "steady_state_error", base).answer is opposite


def test_a_sweep_of_failures_is_not_judged():
    sweep = curve([1, 2, 3, 4], ok=[True, True, False, False])
    assert criteria.rises(sweep, "steady_state_error").answer is Answer.NOT_JUDGED


def test_crossings():
    assert criteria.crossings(np.array([0.0, 1.0, 2.0]), np.array([-1.0, 1.0, -3.0])) == [0.5, 1.25]


def test_parts_join():
    yes, no = Judgement(Answer.YES, "a"), Judgement(Answer.NO, "b")
    assert all_of([yes, yes]) == Judgement(Answer.YES, "a; a")
    assert all_of([yes, no]).answer is Answer.IN_PART
    assert all_of([no, no]).answer is Answer.NO


@pytest.mark.parametrize("row", rig.TABLE_4_1)
def test_the_rigs_ports_are_the_prototypes(row):
    drawn = derive_geometry(parameter_set("thesis_prototype"), holes=2)
    in_rig = prototype(ASSUMED, row.fixed_drop)
    assert derive_geometry(in_rig, holes=2).port_radius == pytest.approx(drawn.port_radius, rel=1e-12)
    flow, area = rig.SOURCE_FLOW / 2, derive_geometry(in_rig, holes=2).fixed_area_1
    drop = in_rig["density"] / 2 * (flow / (in_rig["fixed_discharge"] * area)) ** 2
    assert drop == pytest.approx(row.fixed_drop, rel=1e-12)


def test_readings_needed_are_enough_and_no_more():
    needed = resolution.readings_for(0.14)
    assert resolution.steady_step(needed) <= 0.14 < resolution.steady_step(needed - 1)


@pytest.mark.parametrize("position", trends.POSITIONS)
def test_a_lossless_pilot_line_leaves_the_ideal_ratio(position):
    assert pilot_line.ratio_with_line_loss(position, 0.0) == pytest.approx(flow_ratio(position, 1.0), rel=1e-12)
    lossy = pilot_line.ratio_with_line_loss(position, 0.3)
    assert abs(lossy - 1) <= abs(flow_ratio(position, 1.0) - 1) + 1e-12
