"""Small stores, made once: of the divider, and of an analytic model of any number of objectives."""

import io
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser

from browsing import PATIENCE, Opened
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.errors import NoFeasibleDesignError
from divideropt.models import Domain, Outcome, Parameter, Quantity, Verdict
from divideropt.report.data import ReportData, read_report
from divideropt.store import Store

DIVIDER = """
name: small
model: {kind: divider, set: {radial_clearance: 3 um}}
variables:
  spool_radius: [6 mm, 16 mm]
  groove_width: [0.6 mm, 2 mm]
  total_pressure_drop: [2 MPa, 10 MPa]
  fixed_drop_ratio: [0.3, 0.99]
  centred_opening: [0.1, 0.9]
objectives:
  steady_state_error: {goal: 0.5 %, weight: 3}
  dynamic_error: {goal: 0.5 mL, weight: 3}
  source_pressure: {goal: 18 MPa}
constraints: {source_pressure: {max: 30 MPa}, stop_clearance: {min: 0 mm}}
reference_point: {steady_state_error: 10 %, dynamic_error: 10 mL, source_pressure: 30 MPa}
strategies:
  nsga2: {population: 12, generations: 3, seeds: [1]}
  complex: {evaluations: 40, seeds: [1]}
verification: {sample: 0}
parallel: {backend: sequential}
"""


ONE = "strategies: {nsga2: {population: 8, generations: 3, seeds: [1, 2]}}"


class Spheres:
    """Squared distances to corners of the unit cube; the front of two is the segment between them."""

    def __init__(self, objectives: int = 2) -> None:
        self._count = objectives
        self.parameters = {f"p{i}": Parameter(f"p{i}", "", "", "", 0.5, Domain(0.0, 1.0)) for i in range(3)}
        self.quantities = {f"q{i}": Quantity(f"q{i}", "", "", "", 1.0) for i in range(objectives)}

    def evaluate(self, designs):
        corners = np.array([[(i >> axis) & 1 for axis in range(3)] for i in range(self._count)])
        distances = ((designs[:, None, :] - corners) ** 2).sum(axis=2)
        return distances, [Verdict(Outcome.OK)] * len(designs)


@pytest.fixture(scope="session", autouse=True)
def spheres_module() -> Iterator[None]:
    """Make the model importable by the name a campaign gives."""
    module = ModuleType("report_spheres")
    module.Spheres = Spheres
    sys.modules["report_spheres"] = module
    yield
    del sys.modules["report_spheres"]


@pytest.fixture(scope="session", name="run_campaign")
def campaign_runner() -> Callable[[str, Path], Store]:
    """`run_campaign(text, folder)`: the store of a campaign that has run."""
    return run_campaign


def run_campaign(text: str, folder: Path) -> Store:
    runner = Runner(parse_campaign(text), folder, 1, io.StringIO())
    try:
        return runner.run().store
    except NoFeasibleDesignError:
        return Store(folder)


@pytest.fixture(scope="session")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    """A finished campaign of the divider; not to be changed."""
    return run_campaign(DIVIDER, tmp_path_factory.mktemp("divider") / "small")


@pytest.fixture(scope="session")
def data(store: Store) -> ReportData:
    return read_report(store)


@pytest.fixture
def spheres(tmp_path: Path) -> Callable[..., Store]:
    """`spheres(objectives, more, goal, strategies)`: a finished campaign of the analytic model."""

    def make(objectives: int, more: str = "", goal: str = "{}", strategies: str = ONE) -> Store:
        names = [f"q{i}" for i in range(objectives)]
        text = f"""
name: spheres
model: {{kind: "report_spheres:Spheres", options: {{objectives: {objectives}}}}}
variables: {{p0: [0, 1], p1: [0, 1], p2: [0, 0.5]}}
objectives: {{{", ".join(f"{name}: {goal}" for name in names)}}}
reference_point: {{{", ".join(f"{name}: 3" for name in names)}}}
{strategies}
parallel: {{backend: sequential}}
{more}
"""
        return run_campaign(text, tmp_path / "spheres")

    return make


@pytest.fixture(scope="module")
def opened(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., Opened]]:
    """`opened(text, script)`: the document in a page of its own, drawn, after a script of the test's."""
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    folder = tmp_path_factory.mktemp("pages")

    def open_page(text: str, script: str = "") -> Opened:
        path = folder / f"{len(list(folder.iterdir()))}.html"
        path.write_text(text, encoding="utf-8")
        found = Opened(context.new_page())
        found.page.set_default_timeout(PATIENCE)
        found.page.on("console", lambda m: found.errors.append(m.text) if m.type == "error" else None)
        found.page.on("pageerror", lambda error: found.errors.append(str(error)))

        def hold(route: Any) -> None:
            if route.request.url == path.as_uri():
                route.continue_()
            else:
                found.requests.append(route.request.url)
                route.abort()

        found.page.route("**/*", hold)
        if script:
            found.page.add_init_script(script)
        found.page.goto(path.as_uri())
        found.page.wait_for_selector("html[data-drawn]")
        return found

    yield open_page
    context.close()
