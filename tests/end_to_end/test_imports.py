"""What answers at once imports little: counted, not timed."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("numpy", "numba", "scipy", "pandas", "pyarrow", "pymoo", "plotly", "pydantic", "pint", "joblib", "rich")

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
    done = subprocess.run(
        [sys.executable, "-c", CALL, *arguments], capture_output=True, text=True, cwd=tmp_path, check=True
    )
    found, modules = json.loads(done.stdout.splitlines()[-1])
    assert found == code
    assert not {m.partition(".")[0] for m in modules} & set(HEAVY)
