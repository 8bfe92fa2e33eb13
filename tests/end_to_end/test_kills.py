"""Random kills of the whole process group cost no logged row and change no cell; `benchmarks/kills.py` does 200."""

import subprocess
import sys
from pathlib import Path

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "kills.py"


def test_twenty_kills_lose_nothing_and_change_nothing():
    command = [sys.executable, str(BENCHMARK), "--kills", "20", "--evaluations", "700"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    name, kills, _, ends, compared, lost, different = done.stdout.splitlines()[-1].split()
    assert (name, int(kills), int(lost), int(different)) == ("all", 20, 0, 0)
    assert int(ends) >= 5
    assert int(compared) > 5_000
