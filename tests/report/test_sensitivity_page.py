"""Studies by the command's own path, their pages in a browser, and what the campaign's report says of them."""

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from browsing import Opened, quiet
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.campaign.study import Asked, run_study, study_of, study_store
from divideropt.errors import UsageError
from divideropt.models import Domain, Parameter
from divideropt.report import read_study, study_text, write_report, write_study
from divideropt.report.display import axis_of, labels_of
from divideropt.report.house_words import house_rows
from divideropt.report.sensitivity_data import INDICES
from divideropt.report.sensitivity_figures import interactions
from divideropt.report.sensitivity_page import render_study
from divideropt.store import Store
from pagechecks import axes_without_words, blank_figures, findings
from sensitivity_models import g_indices, ishigami_indices

PI = "3.141592653589793"
ISHIGAMI = f"""
name: ishigami
model: {{kind: "sensitivity_models:Ishigami"}}
variables: {{x1: [-{PI}, {PI}], x2: [-{PI}, {PI}], x3: [-{PI}, {PI}]}}
objectives: {{f: {{weight: 2}}}}
strategies: {{nsga2: {{population: 8, generations: 2, seeds: [1]}}}}
parallel: {{backend: sequential}}
"""
G = """
name: g
model: {kind: "sensitivity_models:GFunction"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1], x4: [0, 1], x5: [0, 1], x6: [0, 1]}
objectives: {g: {}}
strategies: {nsga2: {population: 8, generations: 2, seeds: [1]}}
parallel: {backend: sequential}
"""
FAILING = """
name: failing
model: {kind: "sensitivity_models:Failing"}
variables: {x1: [0, 1], x2: [0, 1], x3: [0, 1]}
objectives: {lost: {}}
constraints: {kept: {min: 1}}
strategies: {nsga2: {population: 8, generations: 2, seeds: [1]}}
parallel: {backend: sequential}
"""
DIVIDER = Path(__file__).parents[2] / "campaigns" / "divider.yaml"


def studied(text: str, folder: Path, method: str, count: int) -> Store:
    campaign = parse_campaign(text)
    store = study_store(Store(folder), method)
    run_study(study_of(campaign, Asked(method, (), count)), store, 1, io.StringIO(), "again")
    return store


@pytest.fixture(scope="module")
def valve(tmp_path_factory: pytest.TempPathFactory) -> Store:
    """A Sobol study of the divider; not to be changed."""
    return studied(DIVIDER.read_text(), tmp_path_factory.mktemp("valve") / "divider", "sobol", 64)


@pytest.mark.parametrize(("text", "closed"), [(ISHIGAMI, ishigami_indices()), (G, g_indices())])
def test_closed_forms_are_within_the_intervals_of_a_study(text, closed, tmp_path):
    """Every single 95 % interval holds its closed form; none is widened for their number."""
    store = studied(text, tmp_path / "study", "sobol", 4096)
    write_study(store)
    table = pd.read_parquet(store.folder / "indices.parquet")
    first, total, second = closed
    table = table[(table["samples"] == 4096) & ~table["quantity"].isin(["outcome"])]
    exact = [
        second[row.variable, row.with_] if row.kind == "S2" else {"S1": first, "ST": total}[row.kind][row.variable]
        for row in table.rename(columns={"with": "with_"}).itertuples()
    ]
    assert len(table) == 2 * len(first) + len(second)
    assert ((table["low"] <= exact) & (table["high"] >= exact)).all()


def test_a_study_without_failures_is_drawn(opened: Callable[..., Opened], tmp_path):
    store = studied(ISHIGAMI, tmp_path / "study", "sobol", 256)
    page = opened(render_study(read_study(store)))
    quiet(page)
    assert page.count("#bars .bars .point") == 6
    assert page.count("#interactions .textpoint") >= 3
    assert blank_figures(page.page, "#interactions") == []
    assert page.count("#convergence .scatterlayer .trace") == 3
    assert "No design failed" in page.page.locator("#failed").inner_text()
    assert page.page.locator("#undefined li").all_inner_texts() == [
        "outcome ok: it is constant",
        "constant: it is constant",
    ]
    headings = page.page.locator(".house tbody tr td:first-child").all_inner_texts()
    assert [text for text in headings if text] == ["f"]


def test_failures_and_treatments_are_told(opened: Callable[..., Opened], tmp_path):
    store = studied(FAILING, tmp_path / "study", "sobol", 256)
    data = read_study(store)
    document = render_study(data)
    assert axes_without_words(document) == []
    page = opened(document)
    quiet(page)
    text = page.page.locator("#failed").inner_text()
    assert f"{data.failures.total} of 2048 designs failed: {data.failures.total} unsettled (25 %)" in text
    assert page.count("#failures .textpoint") == 30
    rows = page.page.locator(".treatments tbody td:first-child").all_inner_texts()
    assert rows == ["working", "worst", "working", "simulated", "worst"]
    assert "lost, simulated: it is defined throughout in" in page.page.locator("#undefined").inner_text()
    assert findings(page) == []
    assert blank_figures(page.page, ".plot:not(#interactions)") == [], "of a sum there are no interactions"


def test_the_folded_figure_is_drawn_at_the_pages_width_when_unfolded(opened: Callable[..., Opened], valve):
    page = opened(render_study(read_study(valve)))
    quiet(page)
    page.page.locator("#more summary").click()
    wide = page.page.locator("#bars .main-svg").first.bounding_box()["width"]
    page.page.wait_for_function(
        f"document.querySelector('#more-bars .main-svg').getBoundingClientRect().width >= {wide - 1}"
    )


def test_the_house_stands_beside_the_authors(opened: Callable[..., Opened], valve):
    data = read_study(valve)
    page = opened(render_study(data))
    rows = page.page.locator(".house tbody tr").all_inner_texts()
    assert [row.split("\t")[0] for row in rows[:5]] == [
        "steady-state error",
        "dynamic error",
        "pressure losses",
        "stability",
        "cost a judgement",
    ]
    assert [row.split("\t")[1] for row in rows[:5]] == ["3", "3", "1", "D", "–"]
    bracketed = [[cell.author for cell in row.cells] for row in house_rows(data.house)]
    assert bracketed[:4] == [list("43421"), list("33423"), list("01423"), list("42311")]
    marked = page.count(".house td.differs")
    assert marked == sum(d != 0 for d in data.house.differences) > 0


def test_a_morris_study_is_drawn(opened: Callable[..., Opened], tmp_path):
    store = studied(FAILING, tmp_path / "study", "morris", 40)
    write_study(store)
    assert set(pd.read_parquet(store.folder / "indices.parquet")["kind"]) == {"mu", "mu_star", "sigma"}
    document = (store.folder / "report.html").read_text()
    assert axes_without_words(document) == []
    page = opened(document)
    quiet(page)
    assert page.count("#effects .scatterlayer .point") == 3
    assert page.count("#house") == 0
    assert "gives no effect" in page.page.locator("#failed").inner_text()
    assert findings(page) == []
    assert blank_figures(page.page) == []


@pytest.mark.parametrize(("method", "count"), [("sobol", 64), ("morris", 10)])
def test_a_study_in_which_all_failed_has_no_figure_without_marks(method, count, tmp_path):
    lost = FAILING.replace("{lost: {}}", "{kept: {}}").replace("x1: [0, 1]", "x1: [0, 0.2]")
    data = read_study(studied(lost, tmp_path / "study", method, count))
    assert data.failures.share == 1.0
    assert set(data.indices["treatment"]) == {"simulated"}
    assert (data.objectives, data.others) == ((), ())
    page = render_study(data)
    assert 'id="effects"' not in page
    assert 'id="bars"' not in page
    assert page.count("<td>simulated</td>") == 1  # what the failed designs have all the same is in the table


def test_the_text_has_the_numbers_and_the_house(valve):
    data = read_study(valve)
    text = study_text(data)
    assert f"{data.failures.total} of 768 designs failed" in text
    found = data.first("source_pressure", "ST").loc["centred_opening"]
    assert f"{found['value']:.2f} ± {found['high'] - found['value']:.2f}" in text
    assert "House of Quality" in text
    assert text.splitlines()[-1].startswith("Worth optimising: ")


def test_effects_are_told_in_the_quantitys_unit(tmp_path):
    store = studied(DIVIDER.read_text(), tmp_path / "study", "morris", 10)
    text = study_text(read_study(store))
    assert "magnitude of dynamic error [mL]: mu_star and sigma" in text
    assert "source pressure [MPa]" in text
    assert "GPa" not in text


def test_an_objective_without_numbers_says_why(tmp_path):
    constant = FAILING.replace("{lost: {}}", "{lost: {goal: 1}, kept: {}}").replace("x1: [0, 1]", "x1: [0, 0.2]")
    for method, count in (("sobol", 2), ("morris", 10)):
        text = study_text(read_study(studied(constant, tmp_path / method, method, count)))
        assert "lost: no numbers, since it is defined in no design that counts" in text  # where all of them fail
        assert "–  –" not in text.partition("House of Quality")[0]
        assert "the author's" not in text  # whose model this is not


def test_a_small_effect_is_not_written_as_0(tmp_path):
    small = ISHIGAMI.replace("sensitivity_models:Ishigami", "sensitivity_models:SmallIshigami")
    text = study_text(read_study(studied(small, tmp_path, "morris", 10)))
    rows = [line.split(maxsplit=1) for line in text.splitlines() if line.startswith("  x")]
    assert [name for name, _ in rows] == ["x1", "x2", "x3"]
    assert all("·10⁻¹" in number and " 0.00" not in number for _, number in rows)


def test_the_campaigns_report_shows_its_studies(opened: Callable[..., Opened], tmp_path):
    folder = tmp_path / "whole"
    store = Runner(parse_campaign(ISHIGAMI), folder, 1, io.StringIO()).run().store
    study = studied(ISHIGAMI, folder, "sobol", 64)
    studied(ISHIGAMI, folder, "morris", 10)
    write_study(study)
    page = opened(write_report(store).read_text())
    assert page.errors == page.requests == []
    assert page.count("#study-sobol .bars .point") == 6
    links = page.page.eval_on_selector_all("#sensitivity a", "found => found.map(a => a.getAttribute('href'))")
    assert links == ["sensitivity/sobol/report.html"], "a study without a page is named and not linked"
    assert (folder / links[0]).is_file()
    assert "Morris" in page.page.locator("#sensitivity").inner_text()


def _words(table):
    return table.assign(value="<b>1</b>")


def _twice(table):
    return pd.concat([table, table])


def _unknown(table):
    return table.assign(samples=np.nan)


def _nobody(table):
    return table.assign(quantity=7)


@pytest.mark.parametrize("damage", [_words, _twice, _unknown, _nobody])
def test_a_table_of_indices_that_is_none_is_left_out_of_the_report(damage, tmp_path):
    folder = tmp_path / "whole"
    store = Runner(parse_campaign(ISHIGAMI), folder, 1, io.StringIO()).run().store
    study = studied(ISHIGAMI, folder, "sobol", 32)
    write_study(study)
    assert 'id="study-sobol"' in write_report(store).read_text()
    table = pd.read_parquet(study.folder / INDICES)
    damage(table).to_parquet(study.folder / INDICES)
    assert 'id="study-sobol"' not in write_report(store).read_text()


def test_labels_are_all_different():
    """Two of one label are one place of a figure."""
    names = ("load_1", "load_2")
    entries = [Parameter(name, "", "P", "a load", 1.0, Domain()) for name in names]
    assert labels_of([axis_of(entry, [1.0]) for entry in entries]) == ["load 1", "load 2"]
    entries = [Parameter(name, "", symbol, "", 1.0, Domain()) for name, symbol in (("a_b", "c"), ("a b", "c"))]
    assert labels_of([axis_of(entry, [1.0]) for entry in entries]) == ["a_b", "a b"]
    entries = [Parameter(name, "", symbol, "", 1.0, Domain()) for name, symbol in (("a", "α"), ("b", ""))]
    assert labels_of([axis_of(entry, [1.0]) for entry in entries]) == ["α", "b"]


def test_many_pairs_are_drawn_as_one_trace_of_numbers(tmp_path):
    """As annotations they took minutes where variables are some dozens."""
    figure = interactions(read_study(studied(G, tmp_path, "sobol", 32)))
    assert [len(trace.text) for trace in figure.data if trace.type == "scatter"] == [15]
    assert len(figure.layout.annotations) == 1  # the panel's title


def test_an_unfinished_study_says_so(tmp_path):
    campaign = parse_campaign(ISHIGAMI)
    store = studied(ISHIGAMI, tmp_path / "study", "sobol", 64)
    larger = study_of(campaign, Asked("sobol", (), 128))
    store.write_campaign(dump_campaign(larger))
    data = read_study(store)
    assert data.notes == ("Not finished: 512 of 1024 designs are simulated.",)
    assert data.units == 64


def test_the_report_of_a_study_is_its_page(tmp_path):
    store = studied(ISHIGAMI, tmp_path / "study", "morris", 10)
    page = write_study(store).read_text("utf-8")
    assert "Elementary effects" in page
    assert write_report(store, tmp_path / "again.html").read_text("utf-8") == page
    write_report(store)
    assert (store.folder / "report.html").read_text("utf-8") == page


def test_what_is_no_study_is_refused(tmp_path):
    store = Runner(parse_campaign(ISHIGAMI), tmp_path / "whole", 1, io.StringIO()).run().store
    with pytest.raises(UsageError, match="strategies nsga2: no sensitivity study"):
        write_study(store)


def test_the_same_data_give_the_same_page(valve):
    one, other = read_study(valve), read_study(valve)
    assert render_study(one) == render_study(other)
    np.testing.assert_array_equal(one.indices["low"], other.indices["low"])
