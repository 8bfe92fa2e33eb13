"""The page of claims agrees with itself, with fresh runs and with the author's code; its criteria can fail."""

import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from claims import author, criteria, drops, grooves, pilot_line, radius, resolution, slip, trends
from claims.experiment import ASSUMED, prototype
from claims.findings import findings
from claims.judgement import Answer, Judged, Judgement, all_of, named
from claims.page import CASES, CLAIMS, write_pages
from claims.runs import VARIANTS, Runs, Sweep

from divideropt.models.divider import FORMULATIONS, parameter_set, rig
from divideropt.models.divider.geometry import derive_geometry
from divideropt.models.divider.ideal import flow_ratio

PAGES = Path(__file__).parents[2] / "docs" / "model"
PAGE, CASES_PAGE = ((PAGES / name).read_text(encoding="utf-8") for name in (CLAIMS, CASES))
PARTS = re.split(r"^\*\*([ABK]\d+)\.\*\* ", PAGE, flags=re.MULTILINE)
STATEMENTS = dict(zip(PARTS[1::2], PARTS[2::2], strict=True))
NAMES = [str(variant) for variant in VARIANTS]


@pytest.fixture(scope="module")
def runs():
    return {str(variant): Runs(variant) for variant in VARIANTS}


def block(quotation):
    """What the page has from a statement to the next one."""
    (found,) = (part for part in STATEMENTS.values() if part.startswith(f"“{quotation}”"))
    return found


def curve(values, ok=None):
    """A sweep over 0 to 1 with these values of the error."""
    found = np.array(values, dtype=float)
    alright = np.ones(len(found), dtype=bool) if ok is None else np.array(ok)
    return Sweep(np.linspace(0, 1, len(found)), {"steady_state_error": found}, alright, "")


@pytest.mark.parametrize(("letter", "names"), [("A", NAMES), ("B", list(FORMULATIONS)), ("K", list(FORMULATIONS))])
def test_its_counts_are_those_of_its_answers(letter, names):
    parts = [part for label, part in STATEMENTS.items() if label[0] == letter]
    for name in names:
        found = [re.search(rf"^\| {name} \| \*\*([a-z ]+)\*\*", part, re.MULTILINE) for part in parts]
        answers = Counter(match[1] if match else "not judged" for match in found)  # no table: not judged
        counts = [*(answers[answer] for answer in Answer), len(parts)]
        assert f"| {name} | {' | '.join(map(str, counts))} |" in PAGE


def test_its_numbers_run_on():
    for letter in "ABK":
        labels = [label for label in STATEMENTS if label[0] == letter]
        assert labels == [f"{letter}{number + 1}" for number in range(len(labels))]


def test_its_main_findings_are_its_answers():
    pattern = re.compile(r"^\| (\w+) \| \*\*([a-z ]+)\*\*: (.*) \|$", re.MULTILINE)
    judged = []
    for label, part in STATEMENTS.items():
        found = {name: Judgement(Answer(answer), figures) for name, answer, figures in pattern.findall(part)}
        judged.append(Judged(label, part.removeprefix("“").split("” (")[0], found))
    assert "\n".join(findings(judged)) in PAGE


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
        assert f"| as assumed | {errors} | {volumes} |" in CASES_PAGE.split(f"## `{name}`")[1]


def test_its_rig_comes_out_as_runs_say_now():
    tests = [trends.assumed(name) for name in FORMULATIONS]
    for i, row in enumerate(rig.TABLE_4_1):
        differences = ", ".join(f"{1e-3 * found.drops[i].load_difference:.0f}" for found in tests)
        drop = tests[0].drops[i].drop
        lower = 100 * (1 - drop / row.fixed_drop)
        assert f"| 4.1 | {1e-3 * row.fixed_drop:.0f} kPa | {1e-3 * drop:.0f} kPa | {lower:.0f} % |" in PAGE
        assert f"| 1630 kPa | {differences} kPa |" in PAGE


def test_its_powers_are_of_the_drops_that_come_out():
    rows = rig.TABLE_4_1
    measured = trends.drop_exponent([row.steady_error for row in rows], [row.fixed_drop for row in rows])
    assert f"to the power {measured:.2f}." in PAGE
    for name in FORMULATIONS:
        exponent = trends.realised_exponent(trends.assumed(name))
        assert f"; the power {exponent:.2f} as assumed" in STATEMENTS["K1"].split(f"| {name} |")[1].split("\n")[0]
        assert -1.1 < exponent < 2 * measured  # the order, not the strength


def test_its_slip_is_what_runs_say_now():
    assert slip.leakage_note() in PAGE


@pytest.mark.parametrize("name", ["conservative", "listing"])
def test_its_overshoot_is_what_runs_say_now(runs, name):
    beyond = [f"{1e2 * flow:.1f} %" for flow in drops.overshoots(runs[name], drops.USUAL_DROP)]
    assert f"at 3 MPa QL1 by {beyond[0]}, QL2 by {beyond[1]}" in block(
        "if the pressure drop is too small, the flows overshoot"
    )


@pytest.mark.slow
def test_they_are_what_their_command_writes():
    assert write_pages() == {CLAIMS: PAGE, CASES: CASES_PAGE}


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


def test_a_statement_is_found_by_its_beginning():
    one, other = Judged("A1", "the flows overshoot", {}), Judged("A2", "the flows", {})
    assert named([one, other], "the flows o") is one
    with pytest.raises(LookupError, match="2 statements begin"):
        named([one, other], "the flows")


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
