"""Reports with little in them: nothing feasible, one objective, a few designs, a model that vouches for none."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from browsing import NO_WEBGL, Opened, quiet
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.plan import build_problem
from divideropt.models import Outcome
from divideropt.report.choosing import VOUCHED, choosing_of
from divideropt.report.data import ReportData, read_report
from divideropt.report.headline import headline_of
from divideropt.report.page import render_report
from divideropt.store import Store

CITATION = Path(__file__).parents[2] / "CITATION.cff"


def words_of(page: str) -> str:
    """The page's text, without tags, spaces as one."""
    body = page.split("<main", 1)[1].split("<script", 1)[0]
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", "", body))


def test_what_no_design_meets_is_named_and_no_axes_are_empty(
    spheres: Callable[..., Store], opened: Callable[..., Opened]
) -> None:
    data = read_report(spheres(2, "constraints: {q0: {max: -1}, q1: {max: 100}}", "{goal: 0.5}"))
    page = render_report(data)
    text = words_of(page)
    assert (
        "No design is feasible. There is no front to draw. Most stand against q0 at most −1, which 48 of 48" in text
    )
    assert "there is neither a hypervolume nor a best design to follow" in text
    found = opened(page, NO_WEBGL)
    assert found.count(".plot") == 0
    quiet(found)


def test_where_all_failed_the_page_says_how(spheres: Callable[..., Store]) -> None:
    data = read_report(spheres(2, "constraints: {q0: {max: -1}}"))
    evaluations = sum(run.evaluations for run in data.runs)
    runs = tuple(
        replace(
            run, outcomes={Outcome.NOT_COMPLETED: run.evaluations}, examples={Outcome.NOT_COMPLETED: "it gave up"}
        )
        for run in data.runs
    )
    failed = replace(data, runs=runs, failing=replace(data.failing, failed=evaluations, worked=0, bounds=()))
    text = words_of(render_report(failed))
    assert "Every simulation failed, most of them not_completed (the first: it gave up)" in text
    assert "Most stand against" not in text
    assert "or look at one design with divideropt evaluate." in text


def test_one_objective_has_a_best_design_and_no_front(spheres: Callable[..., Store]) -> None:
    data = read_report(spheres(1))
    text = words_of(render_report(data))
    assert f"{data.front[0].design_id} has the least q0." in text
    assert "With one objective there is no front but its least value." in text
    assert "Click a point" not in text


@pytest.mark.parametrize(("count", "words"), [(3, "projected on pairs"), (6, "projected on 6 of the 15 pairs")])
def test_the_projections_say_of_how_many_pairs_they_are(
    count: int, words: str, spheres: Callable[..., Store]
) -> None:
    assert words in words_of(render_report(read_report(spheres(count))))


def test_the_best_that_the_model_vouches_for_is_named_where_the_best_is_not(data: ReportData) -> None:
    first, second, *others = (replace(design, valid=False) for design in data.front)
    second = replace(second, valid=True)
    front, best = (first, second, *others), [first]
    objectives = data.objectives
    asked = build_problem(parse_campaign(data.campaign)).objectives
    head = headline_of(front, best, objectives)
    assert head.within == second
    assert headline_of((first, *others), best, objectives).within is None
    assert headline_of(front, [second], objectives).within is None, "the best itself"
    choosing = choosing_of(front, asked, None)
    reasons = {candidate.design.design_id: candidate.reasons for candidate in choosing.candidates}
    assert VOUCHED in reasons[second.design_id]
    assert sum(VOUCHED in why for why in reasons.values()) == 1
    assert all(VOUCHED not in c.reasons for c in choosing_of((first, *others), asked, None).candidates)
    text = words_of(render_report(replace(data, front=front, headline=head, choosing=choosing)))
    assert f"It lies beyond what the model assumes; {second.design_id} is the best of the front that does not" in text


def test_the_selected_design_says_whether_the_model_vouches_for_it(
    data: ReportData, opened: Callable[..., Opened]
) -> None:
    elsewhere = {design.design_id for design in data.best} | {c.design.design_id for c in data.choosing.candidates}
    first = next(design for design in data.front if design.design_id not in elsewhere)
    front = tuple(replace(design, valid=False) if design is first else design for design in data.front)
    found = opened(render_report(replace(data, front=front)), NO_WEBGL)
    found.visit(f"#select={first.design_id}")
    found.page.wait_for_function("(id) => document.getElementById('choice').value === id", arg=first.design_id)
    assert "within what the model assumes no" in " ".join(found.page.locator("#details").inner_text().split())
    quiet(found)


def test_what_to_cite_is_what_the_project_says(data: ReportData, spheres: Callable[..., Store]) -> None:
    asked = yaml.safe_load(CITATION.read_text("utf-8"))
    thesis = asked["references"][0]
    software, source = data.provenance.works
    assert asked["title"] in software
    assert asked["authors"][0]["name"] in software
    assert software.endswith(f"Version {data.provenance.here['divideropt']}.")
    (author,) = thesis["authors"]
    for part in (thesis["title"], f"{author['given-names']} {author['family-names']}", str(thesis["year"])):
        assert part in source
    assert "Saskatchewan" in source
    own = read_report(spheres(2)).provenance
    assert len(own.works) == 1, "a model of one's own has sources of its own"
    assert not any("verify" in command for command, _ in own.commands), "it has no reference"
    assert any("verify" in command for command, _ in data.provenance.commands)
