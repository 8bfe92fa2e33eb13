"""A report of a store whose every string attacks the page: all of it stays text, and nothing leaves."""

import io
import json
import sys
from dataclasses import replace
from types import ModuleType

import numpy as np
import pyarrow as pa
import pytest

from browsing import NO_WEBGL, quiet
from divideropt.campaign.load import parse_campaign, stored_campaign
from divideropt.campaign.runner import Runner
from divideropt.campaign.study import Asked, run_study, study_of
from divideropt.errors import StoreError
from divideropt.models import Domain, Outcome, Parameter, Quantity, Verdict
from divideropt.report import Curve, ResponseCurves, read_study, response_page, write_report
from divideropt.report.convergence import tracks_of
from divideropt.report.data import read_report
from divideropt.report.display import Shown
from divideropt.report.failing import Bound
from divideropt.report.headline import headline_of
from divideropt.report.page import render_report
from divideropt.report.provenance import Provenance
from divideropt.report.sensitivity_page import render_study
from divideropt.report.sweeps_data import read_sweeps
from divideropt.report.sweeps_page import render_sweeps
from divideropt.store import Store

ATTACKS = (
    "</script><script>window.hacked=1</script>",
    '"><img src=x onerror="window.hacked=1">',
    "'><svg onload=window.hacked=1>",
    "{{7*7}}{%raw%}${7*7}<%=7*7%>",
    "javascript:window.hacked=1",
    '<a href="javascript:window.hacked=1">x</a><a href="https://example.org/">y</a>',
    "&lt;script&gt;window.hacked=1&lt;/script&gt;",
    "<!--<script>",
    "]]></style><style>*{display:none}</style>",
    "%{customdata}<b>%{x}</b><br><extra>$\\href{https://example.org/}{z}$</extra>",
    '<meta http-equiv="refresh" content="0;url=https://example.org/">',
    "<iframe srcdoc='<script>parent.hacked=1</script>'></iframe><base href=https://example.org/>",
)
ALL = " ".join(ATTACKS)
UNPRINTABLE = "\u2028window.hacked=1;\u2029\0\x1b[31m\ud7ff\u202e"

LEFT_BEHIND = """() => ({
    hacked: window.hacked ?? null,
    scripts: document.scripts.length,
    handlers: [...document.querySelectorAll("*")].flatMap(e => [...e.attributes]).filter(a => /^on/i.test(a.name))
        .length,
    strangers: document.querySelectorAll("iframe, img, object, embed, base, form, meta[http-equiv=refresh]").length,
    links: [...document.querySelectorAll("a")].map(a => a.getAttribute("href") ?? a.getAttribute("xlink:href"))
        .filter(link => !link?.startsWith("#")),
})"""
CLEAN = {"hacked": None, "scripts": 3, "handlers": 0, "strangers": 0, "links": []}


class Attacking:
    """Spheres, all of whose words attack."""

    def __init__(self, word: str) -> None:
        names = [f"p{i} {ALL}" for i in range(2)]
        self.parameters = {n: Parameter(n, "", ALL, ALL + word, 0.5, Domain(0.0, 1.0), ALL) for n in names}
        units = {f"q0 {ALL}": ALL, f"q1 {ALL}": "", f"q2 {ALL}": ""}  # no goal can be given in the first
        self.quantities = {n: Quantity(n, unit, ALL, ALL, 1.0, signed=True) for n, unit in units.items()}

    def evaluate(self, designs):
        corners = np.eye(3)[:, :2]
        distances = ((designs[:, None, :] - corners) ** 2).sum(axis=2)
        failed = designs[:, 0] > 0.8
        verdicts = [Verdict(Outcome.UNSETTLED, ALL + UNPRINTABLE) if f else Verdict(Outcome.OK, ALL) for f in failed]
        return distances, verdicts


@pytest.fixture(scope="module")
def attacking(tmp_path_factory):
    module = ModuleType("report_attacking")
    module.Attacking = Attacking
    sys.modules["report_attacking"] = module
    model = Attacking("")
    first, *others = model.quantities
    campaign = {
        "name": "attack",
        "model": {"kind": "report_attacking:Attacking", "options": {"word": ATTACKS[0]}},
        "variables": {name: [0, 1] for name in model.parameters},
        "objectives": {first: None} | {name: {"goal": 0.5} for name in others},
        "constraints": {name: {"max": 9} for name in others},
        "strategies": {"nsga2": {"population": 20, "generations": 2, "seeds": [1, 2]}},
        "parallel": {"backend": "sequential"},
    }
    folder = tmp_path_factory.mktemp("attack") / "store"
    yield Runner(parse_campaign(json.dumps(campaign, indent=1)), folder, 1, io.StringIO()).run().store
    del sys.modules["report_attacking"]


def test_nothing_of_an_attack_runs_or_leaves(opened, attacking):
    found = opened(write_report(attacking).read_text("utf-8"))
    dialogs = []
    found.page.on("dialog", lambda dialog: dialogs.append(dialog.dismiss()))
    assert found.page.evaluate(LEFT_BEHIND) == CLEAN
    texts = found.page.locator("main").inner_text()
    for attack in ATTACKS:
        assert attack.split(" ")[0] in texts.replace("\n", " "), "it is there, as text"
    assert found.page.locator("#campaign").inner_text().count("{{7*7}}") > 5
    row = found.page.locator("#front-table tbody tr").nth(1)
    row.click()
    found.page.locator("#front-table th button").first.click()
    found.page.locator("#projection-0-1").scroll_into_view_if_needed()
    dot = found.dots("0-1")[0]
    found.page.mouse.move(dot["x"] - 3, dot["y"])
    found.page.mouse.move(dot["x"], dot["y"])
    found.page.wait_for_selector("#projection-0-1 .hoverlayer text")
    assert "%{x}" in found.page.locator("#projection-0-1 .hoverlayer").text_content()
    assert found.page.evaluate(LEFT_BEHIND) == CLEAN
    assert dialogs == []
    quiet(found)


@pytest.mark.parametrize("method", ["sobol", "morris", "oat"])
def test_a_studys_page_stays_text_too(opened, attacking, method, tmp_path):
    study = study_of(stored_campaign(attacking), Asked(method, (), {"sobol": 16, "morris": 20, "oat": 16}[method]))
    store = Store(tmp_path / "study")
    if method == "oat":
        assert not Runner(study, store.folder, 1, io.StringIO()).sample()
        text = render_sweeps(read_sweeps(store))
    else:
        run_study(study, store, 1, io.StringIO(), "again")
        text = render_study(read_study(store))
    found = opened(text)
    found.page.evaluate("document.querySelectorAll('details').forEach(e => { e.open = true; })")
    assert "window.hacked" in found.page.locator(".plot").first.text_content()
    assert found.page.evaluate(LEFT_BEHIND) == CLEAN
    quiet(found)


def _hostile(axis, text):
    return replace(axis, name=text, words=text, symbol=text, description=text, shown=Shown(text, 1.0))


def test_names_that_no_campaign_can_have_stay_text_too(opened, data):
    hostile = ALL + UNPRINTABLE
    designs = tuple(replace(d, design_id=f"{hostile}{i}", strategy=hostile) for i, d in enumerate(data.front))
    responses = replace(
        data.responses,
        designs=tuple(replace(r, name=d.design_id) for r, d in zip(data.responses.designs, designs, strict=False)),
        sets=tuple(replace(r, name=hostile) for r in data.responses.sets),
        notes=(hostile,),
    )
    changed = replace(
        data,
        name=hostile,
        campaign=hostile,
        front=designs,
        responses=responses,
        sheets=None,
        runs=tuple(
            replace(
                run,
                name=hostile,
                strategy=hostile + run.strategy,
                examples=dict.fromkeys(run.outcomes, hostile),
                ending=hostile,
            )
            for run in data.runs
        ),
        variables=tuple(replace(v, axis=_hostile(v.axis, hostile)) for v in data.variables),
        objectives=tuple(replace(o, axis=_hostile(o.axis, hostile)) for o in data.objectives),
        best=tuple(replace(d, design_id=hostile, strategy=hostile) for d in data.best),
        setting=((hostile, hostile),),
        constraints=(hostile,),
        notes=(hostile,),
        provenance=Provenance({hostile: hostile}, ({hostile: hostile},), ((hostile, hostile),), hostile),
    )
    runs, along = changed.runs, data.failing.along
    tracks = tracks_of(runs, changed.objectives)
    failing = replace(
        data.failing,
        along=tuple(replace(one, axis=_hostile(one.axis, hostile)) for one in along),
        bounds=(Bound(hostile, 1, 1),),
    )
    headline = headline_of(changed.front, changed.best, changed.objectives)
    changed = replace(changed, tracks=tracks, failing=failing, headline=headline)
    found = opened(render_report(changed), NO_WEBGL)
    assert "window.hacked" in found.page.locator("#response .legend").text_content()
    assert found.page.evaluate(LEFT_BEHIND) == CLEAN
    quiet(found)


def test_a_response_page_stays_text_too_and_may_evaluate_nothing(opened):
    curves = (Curve(ALL, ALL, [0.0, 1.0], ALL), Curve("x", "m", [0.0, 1.0]))
    text = response_page(ALL + UNPRINTABLE.replace("\0", ""), ResponseCurves([0.0, 1.0], curves))
    assert "unsafe-eval" not in text.partition("<style>")[0]
    found = opened(text)
    assert found.page.evaluate(LEFT_BEHIND) == CLEAN
    quiet(found)


INJECTED = (
    "<script>window.hacked=1</script>",
    "<img src='https://example.org/x.png' onerror='window.hacked=1'>",
    "<svg onload='window.hacked=1'></svg>",
    "<iframe srcdoc='<script>parent.hacked=1</script>'></iframe>",
    "<link rel=stylesheet href='https://example.org/x.css'><style>@import 'https://example.org/y.css'</style>",
    "<object data='https://example.org/x'></object><embed src='https://example.org/y'>",
    "<video src='https://example.org/x'></video><style>body{background:url(https://example.org/b)}</style>",
    "<form id=f action='https://example.org/'></form>",
    "<base href='https://example.org/'>",
)


BEACON = """new Promise((done) => {
    document.addEventListener("securitypolicyviolation", (event) => done(event.effectiveDirective));
    navigator.sendBeacon("https://example.org/", "1");
})"""
"""Asks for what the page's policy refuses, and waits until it has."""


def test_what_gets_into_the_page_all_the_same_can_do_nothing(opened):
    text = response_page("x", ResponseCurves([0.0, 1.0], (Curve("x", "m", [0.0, 1.0]),)))
    found = opened(text.replace("</main>", "".join(INJECTED) + "</main>"))
    found.page.evaluate("document.getElementById('f')?.submit()")
    found.page.evaluate("fetch('https://example.org/').catch(() => 0)")
    assert found.page.evaluate(BEACON) == "connect-src"
    assert found.page.evaluate("window.hacked ?? null") is None
    assert found.page.evaluate("document.baseURI").startswith("file:")
    assert found.requests == []


def test_a_design_that_is_not_named_as_ours_are_is_refused(attacking, monkeypatch):
    import divideropt.report.standing as module  # noqa: PLC0415

    def renamed(*arguments):
        front = _combined(*arguments)
        at = front.column_names.index("design_id")
        return front.set_column(at, front.schema.field(at), pa.array([f"<b>{i}" for i in range(len(front))]))

    _combined = module.combined_front
    monkeypatch.setattr(module, "combined_front", renamed)
    with pytest.raises(StoreError, match="'<b>0', not <run>/<index>"):
        read_report(attacking)
