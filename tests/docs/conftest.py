"""The documentation as `poe docs` builds it, once for all tests."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from filelock import FileLock

from following import ROOT

Sphinx = Callable[[Path, Path], subprocess.CompletedProcess[str]]


@pytest.fixture(scope="session", name="sphinx")
def _sphinx() -> Sphinx:
    """`sphinx(source, built)` builds pages as `poe docs` does."""

    def build(source: Path, built: Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-n", "-q", source, built],
            capture_output=True,
            text=True,
            check=False,
            env=os.environ | {"PYTHONPATH": f"{ROOT / 'src'}{os.pathsep}{ROOT / 'docs'}"},
        )

    return build


@pytest.fixture(scope="session", name="site")
def _site(tmp_path_factory: pytest.TempPathFactory, sphinx: Sphinx) -> Path:
    """The folder of the pages; a warning is an error. The processes that test share it."""
    ours = tmp_path_factory.getbasetemp()
    folder = (ours.parent if "PYTEST_XDIST_WORKER" in os.environ else ours) / "site"
    with FileLock(f"{folder}.lock"):
        if not folder.exists():
            done = sphinx(ROOT / "docs", folder)
            assert (done.returncode, done.stderr) == (0, "")
    return folder
