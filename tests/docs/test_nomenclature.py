"""A reader of the nomenclature finds everything by its name, and nothing that is not there."""

import re

import pytest
from make_model_pages import PAGES
from modelpages.blocks import block

from divideropt.models.divider import PARAMETER_SETS, PARAMETERS, QUANTITIES

PAGE = (PAGES / "nomenclature.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(("name", "known"), [("parameters", PARAMETERS), ("quantities", QUANTITIES)])
def test_each_has_a_row_with_its_unit_and_no_other_has_one(name, known) -> None:
    rows = [line.split(" | ") for line in block(PAGE, name).splitlines()[2:]]
    assert [row[0].strip("| `") for row in rows] == list(known)
    for row, item in zip(rows, known.values(), strict=True):
        unit = row[2].replace("³", "^3").replace("²", "^2")
        assert unit == (item.unit or "1")


def test_the_sets_table_has_every_set_and_every_parameter_it_changes() -> None:
    header, _, *rows = block(PAGE, "sets").splitlines()
    assert re.findall(r"`(\w+)`", header) == [name for name, changes in PARAMETER_SETS.items() if changes]
    changed = {name for changes in PARAMETER_SETS.values() for name in changes}
    assert {row.split("`")[1] for row in rows} == changed
