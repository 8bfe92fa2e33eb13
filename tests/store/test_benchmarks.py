"""A death at every 13th step of every write, and some damage to every file: short runs of the two benchmarks."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


def called(name, *arguments):
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    command = [sys.executable, str(BENCHMARKS / name), *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_a_death_at_any_step_of_a_write_costs_nothing_that_is_logged():
    said = called("failpoints.py", "--every", "13")
    counts = re.findall(r"^(.*): (\d+) of (\d+) recovered; (\d+) steps", said, re.M)
    assert [name for name, *_ in counts] == ["run", "run, extending", "verify"]
    for _, recovered, tried, steps in counts:
        assert recovered == tried
        assert int(tried) == -(-int(steps) // 13) >= 4


@pytest.mark.parametrize("times", [1, pytest.param(4, marks=pytest.mark.slow)])
def test_a_damaged_file_is_read_right_or_refused_by_its_name(times):
    said = called("damage.py", "--times", str(times))
    rows = re.findall(r"^(\S+) +(cut off|bit) +(\d+) +(\d+) +(\d+)$", said, re.M)
    files = {name for name, *_ in rows}
    assert len(rows) == 2 * len(files) >= 16
    for name, _, same, refused, wrong in rows:
        assert int(wrong) == 0
        assert int(same) + int(refused) == 4 * times
        assert int(refused) == 4 * times if name.startswith(("evaluations", "campaign")) else True
