"""Random kills of the whole process group cost no logged row and change no cell; `benchmarks/kills.py` does 200."""

import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "kills.py"


@pytest.mark.parametrize(
    ("kills", "least", "campaigns"),
    [
        (8, 2, ["complex", "mixed"]),  # one process, and all strategies on two workers
        pytest.param(32, 8, [], marks=pytest.mark.slow),
    ],
)
def test_kills_lose_nothing_and_change_nothing(kills, least, campaigns):
    """Each campaign comes to its end at least once; the rows of a run are compared at each end, and at each kill."""
    command = [sys.executable, str(BENCHMARK), "--kills", str(kills), "--evaluations", "700", *campaigns]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    name, killed, _, ends, compared, lost, different = done.stdout.splitlines()[-1].split()
    assert (name, int(killed), int(lost), int(different)) == ("all", kills, 0, 0)
    assert int(ends) >= least
    assert int(compared) > 700 * least
