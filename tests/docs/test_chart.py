"""Charts put data where the axes say, and write themselves the same twice."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from modelpages.axis import Axis
from modelpages.chart import Area, Dots, Line, Note, Panel, draw
from modelpages.tables import fixed, power, table


def test_an_axis_maps_its_ends_and_middle() -> None:
    axis, powers = Axis(0.0, 20.0, 100.0, 300.0), Axis(1e-6, 1e2, 300.0, 100.0, log=True)
    assert (axis(0.0), axis(10.0), axis(20.0)) == (100.0, 200.0, 300.0)
    assert (powers(1e-6), powers(1e-2), powers(1e2)) == pytest.approx((300.0, 200.0, 100.0))


@pytest.mark.parametrize(
    ("low", "high", "words"),
    [
        (0.0, 20.0, ["0", "5", "10", "15", "20"]),
        (0.25, 0.75, ["0.3", "0.4", "0.5", "0.6", "0.7"]),
        (-2.0, 2.0, ["−2", "−1", "0", "1", "2"]),
    ],
)
def test_ticks_are_round_and_inside(low, high, words) -> None:
    assert [written for _, written in Axis(low, high, 0.0, 1.0).ticks()] == words


def test_logarithmic_ticks_are_the_powers_of_ten() -> None:
    assert [written for _, written in Axis(1e-2, 10.0, 0.0, 1.0, log=True).ticks()] == ["10⁻²", "10⁻¹", "10⁰", "10¹"]


def test_a_chart_is_sound_xml_that_says_what_it_shows_and_is_the_same_twice() -> None:
    line = Line("a < b", np.array([0.0, 1.0, 2.0]), np.array([0.0, np.nan, 4.0]), 1, "dash")
    panels = [Panel([line], "time [s]", "flow", "title", shade=(0.5, 1.0), notes=(Note("here", 1.0, 2.0),))]
    text = draw(panels, "what & why")
    assert text == draw(panels, "what & why")
    root = ElementTree.fromstring(text)
    words = ["".join(node.itertext()) for node in root.iter("{http://www.w3.org/2000/svg}text")]
    assert {"a < b", "time [s]", "flow", "title", "here"} <= set(words)
    assert root.find("{http://www.w3.org/2000/svg}title").text == "what & why"
    # NaN lifts the pen: two strokes begin, and no line is drawn to nowhere.
    path = re.search(r'<path d="([^"]*)" fill="none" class="s1"', text.split("clip-path=")[1])[1]
    assert path.count("M") == 2
    assert "nan" not in text


def test_tables_and_numbers() -> None:
    assert table(["a", "b"], [["x", "1"]], numbers_from=1) == "| a | b |\n| --- | ---: |\n| x | 1 |"
    assert fixed(-1.25, 1) == "−1.2"
    assert fixed(float("nan"), 1) == "–"
    assert power(-4.04e-8) == "−4.0·10⁻⁸"
    assert power(1e-18, nothing=1e-15) == "0"


def test_areas_and_dots_stand_in_panel_and_legend() -> None:
    x = np.array([0.0, 1.0])
    area, dots = Area("between", x, x, x + 1, 2), Dots("points", x, x, 1, hollow=True)
    text = draw([Panel([Line("", x, x)], "x", "y", areas=[area], dots=[dots])], "what")
    root = ElementTree.fromstring(text)
    words = ["".join(node.itertext()) for node in root.iter("{http://www.w3.org/2000/svg}text")]
    assert {"between", "points"} <= set(words)
    assert "" not in words
    assert len(list(root.iter("{http://www.w3.org/2000/svg}circle"))) == 3  # one of them in the legend
    assert len(re.findall(r'<path d="[^"]*Z" class="f2"', text)) == 2
    assert ".f2{fill:" in text  # dark, too


def test_panels_go_on_in_the_next_row() -> None:
    panel = Panel([Line("a", np.array([0.0, 1.0]), np.array([0.0, 1.0]))], "x", "y")
    one, two = (ElementTree.fromstring(draw([panel] * count, "what", 2)) for count in (2, 3))
    assert one.get("width") == two.get("width") == "800"
    assert int(two.get("height")) > int(one.get("height"))
    assert [node.get("transform") for node in two.findall("{http://www.w3.org/2000/svg}g")].count(
        "translate(0 348)"
    ) == 1
