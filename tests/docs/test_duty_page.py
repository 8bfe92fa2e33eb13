"""The command that writes `docs/model/duty.md`, on small stores, and the page as committed."""

import io
import re
import shutil
from pathlib import Path

import make_duty_page
import pytest
from modelpages.blocks import block

from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner

CAMPAIGNS = Path(__file__).parents[2] / "campaigns"
SMALL = (
    "strategies: {complex: {aggregate: goal_attainment, points: 10, evaluations: EVALUATIONS, seeds: [1]}}\n"
    "verification: {sample: 0}\noptimality: {points: 0}\nparallel: {backend: sequential}\n"
)
EVALUATIONS = {"divider": 300, "ratio": 200, "duty": 150}


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("duty")
    for name, count in EVALUATIONS.items():
        text = (CAMPAIGNS / f"{name}.yaml").read_text(encoding="utf-8")
        small = re.split(r"^strategies:", text, flags=re.MULTILINE)[0] + SMALL.replace("EVALUATIONS", str(count))
        Runner(parse_campaign(small), folder / name, 1, io.StringIO()).run()
    path = folder / "duty.md"
    shutil.copy(make_duty_page.PAGE, path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(make_duty_page, "PAGE", path)
        make_duty_page.main([folder / name for name in EVALUATIONS])
    return path.read_text(encoding="utf-8")


def rows(text: str, name: str) -> list[list[str]]:
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in block(text, name).splitlines()[2:]]


def test_every_block_of_the_page_is_written(page):
    committed = make_duty_page.PAGE.read_text(encoding="utf-8")
    names = re.findall(r"<!-- begin (\S+) -->", committed)
    assert len(names) == 14
    for name in names:
        assert block(page, name)
        assert block(committed, name), "run docs/make_duty_page.py"


def test_the_error_that_rotation_leaves_is_the_regulation(page):
    assert [row[0] for row in rows(page, "rotated")] == ["`low_load_1`", "`low_load_2`"]
    for row in rows(page, "rotated"):
        position, regulation, first, second = map(float, row[3:])
        assert 0.05 < position < 0.3
        assert first == pytest.approx(regulation / 0.7, abs=0.015)  # both are rounded
        assert second == pytest.approx(regulation / 0.3, abs=0.03)


def test_fronts_are_laid_beside_each_other_under_one_problem(page):
    centred, own = rows(page, "ratio-fronts")
    assert (centred[0], own[0]) == ("`divider.yaml`", "`ratio.yaml`")
    assert own[1] == own[2]  # its own front is feasible
    assert int(centred[2]) <= int(centred[1])
    assert int(centred[-1]) + int(own[-1]) > 0
    designs = {row[0].split(",")[0]: row for row in rows(page, "designs")}
    assert float(designs["`ratio.yaml`"][-2]) == pytest.approx(float(own[-3]), abs=0.006)


def test_mirrored_scenarios_are_left_out(page):
    names = [row[0] for row in rows(page, "duty-new")]
    assert names[0] == "`scenario`"
    assert len(names) == 9
    assert not [name for name in names if name.endswith("_2`")]
