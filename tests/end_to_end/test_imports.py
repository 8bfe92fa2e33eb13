"""What answers at once imports little: counted, not timed."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("numpy", "numba", "scipy", "pandas", "pyarrow", "pymoo", "plotly", "pydantic", "pint", "joblib", "rich")

DIVIDER = Path(__file__).parents[2] / "campaigns" / "divider.yaml"

CALL = """
import json, sys
from divideropt.cli import main
try:
    main()
except SystemExit as end:
    print(json.dumps([end.code, sorted(sys.modules)]))
"""


@pytest.mark.parametrize(
    ("arguments", "code"),
    [(["--help"], 0), (["--version"], 0), (["run", "--help"], 0), (["run", "missing.yaml"], 2), (["nonsense"], 2)],
)
def test_what_needs_no_library_imports_none(tmp_path: Path, arguments: list[str], code: int) -> None:
    found, modules = call(arguments, tmp_path)
    assert found == code
    assert not {m.partition(".")[0] for m in modules} & set(HEAVY)


def test_check_imports_what_reads_a_campaign_and_nothing_that_runs_one(tmp_path: Path) -> None:
    found, modules = call(["check", str(DIVIDER)], tmp_path)
    assert found == 0
    unwanted = {"numba", "pint", "pymoo", "pandas", "plotly", "joblib", "scipy.stats", "scipy.optimize", "rich"}
    assert not set(modules) & unwanted


def call(arguments: list[str], folder: Path) -> tuple[int, list[str]]:
    """Run a command in a process of its own, and return its exit code and what it has imported."""
    done = subprocess.run(
        [sys.executable, "-c", CALL, *arguments], capture_output=True, text=True, cwd=folder, check=True
    )
    code, modules = json.loads(done.stdout.splitlines()[-1])
    return code, modules
