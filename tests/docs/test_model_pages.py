"""The pages of `docs/model/` have what the model gives now."""

import re
from xml.etree import ElementTree

import pytest
from make_model_pages import BLOCKS, PAGES, PICTURES
from modelpages.blocks import block, fill
from modelpages.figures import FIGURES

ELSEWHERE = {"sound"}
"""Figures that `docs/make_sound_page.py` draws, for `sound.md`."""

# What is checked against a fresh run; the rest takes up to half a minute a block and comes from the same command.
CHEAP = {
    "nomenclature.md": ["parameters", "sets", "quantities"],
    "pilot.md": ["closed-form", "validity", "groove-loss"],
    "disagreements.md": [
        "in-short",
        "options-base",
        "listing-mended",
        "end-flows",
        "sizing",
        "kwan",
        "drawn",
        "rotated",
        "turned",
        "figure-2-6",
        "starts",
    ],
}


@pytest.mark.parametrize(("page", "name"), [(page, name) for page, names in CHEAP.items() for name in names])
def test_a_table_is_what_the_command_writes_now(page, name) -> None:
    committed = block((PAGES / page).read_text(encoding="utf-8"), name)
    assert committed == BLOCKS[page][name](), "run `poe pages`"


@pytest.mark.parametrize("page", BLOCKS)
def test_every_block_has_its_place_and_is_filled(page) -> None:
    text = (PAGES / page).read_text(encoding="utf-8")
    assert set(re.findall(r"<!-- begin (\S+) -->", text)) == set(BLOCKS[page])
    assert all(block(text, name) for name in BLOCKS[page])


def test_a_figure_that_costs_nothing_is_what_the_command_draws_now() -> None:
    committed = (PICTURES / "figure_2_6.svg").read_text(encoding="utf-8")
    assert committed == FIGURES["figure_2_6"](), "run `poe pages`"


def test_every_figure_is_there_drawn_and_shown() -> None:
    drawn = {path.stem for path in PICTURES.glob("*.svg")}
    assert set(FIGURES) <= drawn <= set(FIGURES) | ELSEWHERE
    shown = "".join(path.read_text(encoding="utf-8") for path in PAGES.glob("*.md"))
    for name in drawn:
        root = ElementTree.parse(PICTURES / f"{name}.svg").getroot()
        assert root.tag.endswith("svg")
        assert f"images/model/{name}.svg" in shown


def test_filling_changes_the_block_alone_and_twice_is_once() -> None:
    page = "a\n<!-- begin t -->\nold\n<!-- end t -->\nb\n"
    once = fill(page, {"t": r"new \1"})
    assert once == "a\n<!-- begin t -->\nnew \\1\n<!-- end t -->\nb\n"
    assert fill(once, {"t": r"new \1"}) == once


@pytest.mark.parametrize("page", ["no markers", "<!-- begin t --><!-- end t --> <!-- begin t --><!-- end t -->"])
def test_filling_needs_one_pair_of_markers(page) -> None:
    with pytest.raises(ValueError, match="pairs of markers; the page must have one"):
        fill(page, {"t": "text"})
