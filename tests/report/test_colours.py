"""The pages' colours, light, dark and on paper: told apart with any colour vision, and seen against the page."""

import re
from importlib.resources import files
from itertools import combinations

import numpy as np
import pytest

from colours import VISIONS, ciede2000, contrast, distance
from divideropt.report.palette import COLOURS, marks

APART = 15.0
"""CIEDE2000 of any two series; Okabe and Ito's first six come to 10.9, the first six of plotly's to 0.7."""

TEXT, PICTURE = 4.5, 3.0
"""Contrast that WCAG 2.2 asks of text (1.4.3, AA) and of what a picture consists of (1.4.11)."""

BEHIND = ("paper", "raised", "chosen", "warn")


def _themes() -> dict[str, dict[str, str]]:
    """Names and colours of each `:root` of the style sheet; what a later one leaves out is the first's."""
    text = files("divideropt.report").joinpath("templates", "report.css").read_text("utf-8")
    found = [
        dict(re.findall(r"--([\w-]+): (#[0-9a-fA-F]{6});", block))
        for block in re.findall(r":root {(.*?)}", text, re.S)
    ]
    light, dark, paper = found[:3]
    return {"light": light, "dark": light | dark, "print": light | paper}


THEMES = _themes()


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("theme", THEMES)
def test_no_two_series_look_alike(theme, vision):
    series = [THEMES[theme][f"series-{i}"] for i in range(len(COLOURS))]
    found = {(a, b): distance(a, b, vision) for a, b in combinations(series, 2)}
    assert {pair: d for pair, d in found.items() if d < APART} == {}


@pytest.mark.parametrize("theme", THEMES)
def test_what_is_drawn_and_written_stands_out(theme):
    colours = THEMES[theme]
    series = {f"series-{i}": contrast(colours[f"series-{i}"], colours["paper"]) for i in range(len(COLOURS))}
    words = {
        (ink, behind): contrast(colours[ink], colours[behind])
        for ink in ("ink", "quiet", "accent", "met", "missed")
        for behind in BEHIND
    }
    assert {name: ratio for name, ratio in series.items() if ratio < PICTURE} == {}
    assert {names: ratio for names, ratio in words.items() if ratio < TEXT} == {}


def test_no_mark_is_told_by_its_colour_alone():
    found = marks([f"strategy {i}" for i in range(len(COLOURS))]).values()
    assert len({mark.shape for mark in found}) == len({mark.colour for mark in found}) == len(COLOURS)


@pytest.mark.parametrize(
    ("first", "second", "apart"),
    [
        ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
        ((50.0, 0.0, 0.0), (50.0, -1.0, 2.0), 2.3669),
        ((50.0, 2.5, 0.0), (73.0, 25.0, -18.0), 27.1492),
        ((50.0, 2.49, -0.001), (50.0, -2.49, 0.0011), 7.2195),
        ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
    ],
)
def test_distances_are_those_of_the_paper(first, second, apart):
    """Table 1 of Sharma, Wu and Dalal (2005)."""
    assert ciede2000(np.array(first), np.array(second)) == pytest.approx(apart, abs=5e-5)
    assert ciede2000(np.array(second), np.array(first)) == pytest.approx(apart, abs=5e-5)


def test_white_stays_white_with_any_vision():
    assert [distance("#ffffff", "#ffffff", vision) for vision in VISIONS] == [0.0] * 4
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    assert all(matrix.sum(axis=1) == pytest.approx(1.0, abs=2e-6) for matrix in VISIONS.values())
