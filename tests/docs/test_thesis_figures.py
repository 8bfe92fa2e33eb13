"""The thesis's figures are all there, verdicts come from judgements, and drawing again changes nothing."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from claims.judgement import Answer, Judgement
from make_thesis_figures import PAGE, PICTURES
from thesisfigures import complex_run
from thesisfigures.catalogue import FIGURES, NOT_DRAWN
from thesisfigures.figure import Row, both_runs, verdicts
from thesisfigures.page import page
from thesisfigures.statements import figures_at
from thesisfigures.thin import MISS, PLOT, thinned

TEXT = PAGE.read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## Figure (\d\.\d+)\n(.*?)(?=^## )", TEXT, re.DOTALL | re.MULTILINE))
CLAIMS = (PAGE.parent / "claims.md").read_text(encoding="utf-8")
BY_NUMBER = {figure.number: figure for figure in FIGURES}

LARGEST, ALL_TOGETHER = 100_000, 800_000
"""Bytes that a drawing, and all of them, may take."""

CHEAP = ["2.6", "3.1", "3.2", "3.6", "3.21", "3.29", "4.5"]


@pytest.fixture(scope="module")
def both():
    return both_runs()


def tables(section):
    """The rows under a figure: label, what is said, and the answer of each variant by name."""
    lines = [line.strip("| ").split(" | ") for line in section.splitlines() if line.startswith("|")]
    names = lines[0]  # what is said, then the variants; a row may have a label before
    return [dict(zip(("said", *names[1:]), line[-len(names) :], strict=True)) for line in lines[2:]]


def answers(section):
    """The verdict that stands in a section, by variant."""
    line = re.search(r"^Does it show what the thesis says\? (.*)\.$", section, re.MULTILINE)[1]
    return dict(re.findall(r"(?:^|; )([^*]+?) \*\*([a-z ]+)\*\*", line))


def test_every_figure_of_the_chapters_is_drawn_or_has_a_reason():
    numbers = [f"2.{n}" for n in range(1, 10)] + [f"3.{n}" for n in range(1, 30)] + [f"4.{n}" for n in range(1, 9)]
    assert sorted([*BY_NUMBER, *NOT_DRAWN]) == sorted(numbers)
    assert [number for number in NOT_DRAWN if number.startswith("3.")] == []
    assert {"2.6", "4.4", "4.5", "4.8"} <= set(BY_NUMBER)
    for number, reason in NOT_DRAWN.items():
        assert f"| {number} | {reason} |" in TEXT


def test_every_drawing_is_there_shown_small_and_has_a_dark_side():
    files = {path.name: path for path in PICTURES.iterdir()}
    assert set(files) == {figure.file for figure in FIGURES}
    for figure in FIGURES:
        drawing = files[figure.file].read_text(encoding="utf-8")
        assert ElementTree.fromstring(drawing).tag.endswith("svg")
        assert "prefers-color-scheme: dark" in drawing
        assert f"]({'../images/thesis/' + figure.file})" in SECTIONS[figure.number]
    sizes = [path.stat().st_size for path in files.values()]
    assert max(sizes) < LARGEST
    assert sum(sizes) < ALL_TOGETHER


@pytest.mark.parametrize("number", BY_NUMBER)
def test_a_verdict_is_what_the_answers_under_it_make(number):
    rows = []
    for row in tables(SECTIONS[number]):
        found = {
            name: Judgement(Answer(re.match(r"\*\*([a-z ]+)\*\*", cell)[1]), "")
            for name, cell in row.items()
            if name != "said"
        }
        rows.append(Row("", row["said"], "", found, not row["said"].startswith("beside it")))
    assert rows
    assert answers(SECTIONS[number]) == {name: str(answer) for name, answer in verdicts(rows).items()}


def test_what_the_page_of_claims_judges_is_answered_as_there():
    compared = 0
    for section in SECTIONS.values():
        for label, said in re.findall(r"^\| ([AB]\d+) \| “(.*?)” \*", section, re.MULTILINE):
            claimed = re.search(
                rf"^\*\*{label}\.\*\* “{re.escape(said)}”.*?(?=^\*\*[ABK]|^#)", CLAIMS, re.DOTALL | re.MULTILINE
            )[0]
            line = next(line for line in section.splitlines() if line.startswith(f"| {label} |"))
            names = section.split("the thesis says | ")[1].split(" |\n")[0].split(" | ")
            for name, answer in zip(names, line.strip("| ").split(" | ")[2:], strict=True):
                if answer != "**not judged**":
                    assert f"| {name} | {answer} |" in claimed
                    compared += 1
    assert compared > 60


@pytest.mark.parametrize("number", CHEAP)
def test_a_figure_is_what_the_command_draws_and_judges_now(both, number):
    figure = BY_NUMBER[number]
    assert figure.draw(both) == (PICTURES / figure.file).read_text(encoding="utf-8"), "run `poe thesis`"
    for row in figure.judge(both):
        assert " | ".join(str(judgement) for judgement in row.found.values()) in SECTIONS[number]
    if figure.note is not None:
        assert figure.note(both) in SECTIONS[number]


@pytest.mark.slow
def test_the_page_and_all_drawings_are_what_the_command_writes(both):
    rows = {figure.number: figure.judge(both) for figure in FIGURES}
    assert page(rows, both) == TEXT
    for figure in FIGURES:
        assert figure.draw(both) == (PICTURES / figure.file).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("place", "figures"),
    [
        ("Fig. 3.4", {"3.4"}),
        ("Figs. 3.8, 3.9", {"3.8", "3.9"}),
        ("Figs. 3.18–3.21", {"3.18", "3.19", "3.20", "3.21"}),
        ("below Fig. 3.9", set()),
        ("eq. 3.23", set()),
        ("Tables 4.1, 4.2", set()),
    ],
)
def test_a_place_names_figures(place, figures):
    assert figures_at(place) == figures


def test_verdicts_join_what_counts_and_was_judged():
    yes, no, not_judged = (Judgement(answer, "") for answer in (Answer.YES, Answer.NO, Answer.NOT_JUDGED))
    rows = [Row("", "", "", {"a": yes, "b": yes}), Row("", "", "", {"a": no, "b": not_judged})]
    assert verdicts(rows) == {"a": Answer.IN_PART, "b": Answer.YES}
    assert verdicts([*rows, Row("", "", "", {"b": no}, counted=False)])["b"] is Answer.YES
    assert verdicts([Row("", "", "", {"a": not_judged})]) == {"a": Answer.NOT_JUDGED}


def test_a_thinned_curve_is_the_same_to_the_eye():
    x = np.linspace(0.0, 1.0, 2001)
    y = np.sin(20 * x) * np.exp(-3 * x)
    a, b = thinned(x, y, (0.0, 1.0), (-1.0, 1.0))
    assert len(a) < 200
    assert (a[0], a[-1]) == (0.0, 1.0)
    slope = np.abs(np.gradient(y, x)).max() * (PLOT[1] / 2) / PLOT[0]  # px upwards a px along
    assert np.abs(np.interp(x, a, b) - y).max() * PLOT[1] / 2 <= MISS * np.hypot(1.0, slope)


def test_a_step_at_one_instant_is_kept():
    x, y = np.array([0.0, 1.0, 1.0, 2.0]), np.array([0.0, 0.0, 1.0, 1.0])
    a, b = thinned(x, y, (0.0, 2.0), (0.0, 1.0))
    assert (a.tolist(), b.tolist()) == (x.tolist(), y.tolist())


def test_a_log_that_is_not_of_reflections_is_found_out():
    points, depths = complex_run.logged_run()
    assert all(step.reflected for step in complex_run.steps_of(points, depths))
    moved = points.copy()
    moved[complex_run.POINTS :] += np.random.default_rng(1).uniform(1e-6, 1e-3, moved[complex_run.POINTS :].shape)
    assert not any(step.reflected for step in complex_run.steps_of(moved, depths))
