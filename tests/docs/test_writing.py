r"""The pages read well where they are read: on GitHub, and built by Sphinx with MyST.

GitHub takes a backslash before a sign of punctuation away before it sets the formula, and may see `}_` and `*` as the
beginning of emphasis. Sphinx splits a display that has `\\` in it, and a `\tag` is then refused.
"""

import re
from pathlib import Path

import pytest
from make_model_pages import PAGES

OWN = ("README.md", "equations.md", "nomenclature.md", "pilot.md", "disagreements.md", "figures.md")
TEXTS = {name: (PAGES / name).read_text(encoding="utf-8") for name in OWN}


def displays(text: str) -> list[str]:
    return re.findall(r"^\$\$\n(.*?)\n\$\$$", text, re.DOTALL | re.MULTILINE)


def inlines(text: str) -> list[str]:
    rest = re.sub(r"^\$\$\n.*?\n\$\$$", "", text, flags=re.DOTALL | re.MULTILINE)
    rest = re.sub(r"`[^`\n]*`", "", rest)
    return re.findall(r"\$([^$\n]+)\$", rest)


def anchor(heading: str) -> str:
    """As GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.replace("`", "").lower()).replace(" ", "-")


@pytest.mark.parametrize("name", OWN)
def test_every_displayed_equation_has_one_number_of_its_own(name) -> None:
    numbers = [re.findall(r"\\tag\{([^}]+)\}", display) for display in displays(TEXTS[name])]
    assert all(len(found) == 1 for found in numbers)
    assert len({found[0] for found in numbers}) == len(numbers)
    assert TEXTS[name].count("$$") == 2 * len(numbers)


@pytest.mark.parametrize("name", OWN)
def test_formulas_survive_markdown(name) -> None:
    for formula in displays(TEXTS[name]) + inlines(TEXTS[name]):
        assert not re.search(r"\\[^a-zA-Z]", formula), formula
        assert not re.search(r"[<>*]", formula), formula
        assert formula.count("{") == formula.count("}"), formula
    assert not [formula for formula in inlines(TEXTS[name]) if "}_" in formula or "|" in formula]


@pytest.mark.parametrize("name", OWN)
def test_the_numbers_that_a_page_refers_to_exist(name) -> None:
    # (E…) and (P…) are ours: each must be displayed on the page that owns it.
    owners = {"E": TEXTS["equations.md"], "P": TEXTS["pilot.md"]}
    for letter, number in re.findall(r"\(([EP])(\d+)\)", TEXTS[name]):
        assert f"\\tag{{{letter}{number}}}" in owners[letter]


@pytest.mark.parametrize("name", OWN)
def test_links_lead_somewhere(name) -> None:
    for target, place in re.findall(r"\]\(([^)#]*)#?([^)]*)\)", TEXTS[name]):
        path = (PAGES / target).resolve() if target else PAGES / name
        assert path.exists(), target
        if place:
            headings = re.findall(r"^#+ (.*)$", Path(path).read_text(encoding="utf-8"), re.MULTILINE)
            assert place in {anchor(heading) for heading in headings}, place
