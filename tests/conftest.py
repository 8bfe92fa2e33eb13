"""What several tests share: designs, the record a kernel reads, and the author's data."""

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from filelock import FileLock
from hypothesis import settings
from numpy.typing import NDArray
from playwright.sync_api import Browser
from scipy.stats import qmc

from browsing import chromium
from divideropt.models.divider import FORMULATIONS, Divider, Scenario, parameter_set
from divideropt.models.divider.coefficients import Valve
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.response import Response

# A run must say the same twice; and the first call of a kernel compiles it, which takes longer than any deadline.
settings.register_profile("divideropt", deadline=None, derandomize=True, database=None)
settings.load_profile("divideropt")

REFERENCE = Path(__file__).parent / "reference"

LISTING_COLUMNS = {
    "r": "spool_radius",
    "b": "groove_width",
    "deltaPt": "total_pressure_drop",
    "Po_Pt": "fixed_drop_ratio",
    "frac_open": "centred_opening",
    "rsr": "stem_ratio",
}
"""The parameters' names in the author's files."""

BOX = {
    "spool_radius": (6e-3, 16e-3),
    "groove_width": (0.6e-3, 2e-3),
    "total_pressure_drop": (2e6, 10e6),
    "fixed_drop_ratio": (0.3, 0.99),
    "centred_opening": (0.1, 0.9),
}
"""Variables and bounds of C.6, SI."""


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """No processes beside this one where files and single tests are named: they are done sooner without."""
    return None if any(Path(argument).is_dir() for argument in config.args) else 0


@pytest.fixture(scope="session", autouse=True)
def _compiled_once(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Of several processes one compiles the model, then the others load it: numba's cache has no lock."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        return
    with FileLock(tmp_path_factory.getbasetemp().parent / "compiled.lock"):
        for formulation in ("conservative", "listing"):
            model = Divider(formulation)
            model.evaluate(np.array([list(_design().values())]))
            measure(model.respond(_design()))


def _design(base: str = "thesis_base", /, **changes: float) -> dict[str, float]:
    unknown = changes.keys() - parameter_set(base).keys()
    assert not unknown, f"no such parameters: {unknown}"
    return parameter_set(base) | changes


@pytest.fixture(scope="session")
def design() -> Callable[..., dict[str, float]]:
    """`design(**changes)`: a named parameter set, Appendix B.1 unless said otherwise, with changes."""
    return _design


@pytest.fixture(scope="session")
def record() -> Callable[..., NDArray[np.record]]:
    """`record(parameters, formulation, phase=-1, scenario, **options)`: what the kernel reads, shape (1,)."""

    def make(
        parameters: dict[str, float],
        formulation: str = "conservative",
        phase: int = -1,
        scenario: Scenario | None = None,
        **options: Any,
    ) -> NDArray[np.record]:
        chosen = scenario or Scenario()
        reading = replace(FORMULATIONS[formulation], **options)
        return Valve.of(parameters, reading).over(chosen.spans()[phase], chosen.source_flow)

    return make


@pytest.fixture(scope="session")
def measured() -> Callable[..., dict[str, Any]]:
    """`measured(model, parameters, response=None)`: quantities by name, and the verdict as "outcome" and "text"."""

    def run(model: Divider, parameters: dict[str, float], response: Response | None = None) -> dict[str, Any]:
        row, verdict = measure(response or model.respond(parameters))
        named = dict(zip(model.quantities, row.tolist(), strict=True))
        return named | {"outcome": verdict.outcome, "text": verdict.text}

    return run


@pytest.fixture(scope="session")
def box_designs() -> Callable[[int], list[dict[str, float]]]:
    """`box_designs(count)`: the first points of a Sobol sequence in the box of C.6, on Appendix B.1."""

    def draw(count: int) -> list[dict[str, float]]:
        lower, upper = np.array(list(BOX.values())).T
        power = int(np.ceil(np.log2(count)))
        points = qmc.scale(qmc.Sobol(len(BOX), rng=0).random_base2(power), lower, upper)[:count]
        return [_design(**dict(zip(BOX, point.tolist(), strict=True))) for point in points]

    return draw


@pytest.fixture(scope="session")
def reference() -> Callable[[str], pd.DataFrame]:
    """`reference(name)`: one of the author's files, see tests/reference/README.md."""

    def read(name: str) -> pd.DataFrame:
        text = pd.read_csv(REFERENCE / f"{name}.csv", dtype=str, keep_default_na=False)
        words = {"kind", "pset", "param"}
        # `float` rounds correctly; pandas's own parser need not, and a last bit decides what is on a port's edge.
        return pd.DataFrame({c: text[c] if c in words else [float(v or "nan") for v in text[c]] for c in text})

    return read


@pytest.fixture(scope="session")
def listing_design() -> Callable[[Any], dict[str, float]]:
    """`listing_design(row)`: the parameters of a row of the author's files."""

    def convert(row: Any) -> dict[str, float]:
        return _design(**{name: float(getattr(row, column)) for column, name in LISTING_COLUMNS.items()})

    return convert


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """One for all tests of pages; while it is there, `asyncio.run` is refused in this thread."""
    with chromium() as browser:
        yield browser
