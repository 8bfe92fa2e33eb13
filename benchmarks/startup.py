"""How long a command takes that a person waits for: `--help` and `check`, against what their libraries cost alone.

    python benchmarks/startup.py [--times N]

Prints, best of N processes: seconds by the clock and of the processor. The two differ where the machine is shared.
Then what a `check` imports costs by itself, from `python -X importtime`, the dearest libraries first.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

LIMITS = {"--help": 0.3, "check": 1.0}
"""What the commands are to stay below [s]."""

SHOWN = 12
"""Libraries that are listed."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--times", type=int, default=5, help="processes of each command")
    times = parser.parse_args().times
    with tempfile.TemporaryDirectory() as folder:
        campaign = Path(folder) / "divider.yaml"
        campaign.write_text(files("divideropt.campaign").joinpath("divider.yaml").read_text("utf-8"), "utf-8")
        calls = {
            "python": ["-c", "pass"],
            "numpy and numba": ["-c", "import numpy, numba"],
            "--help": ["-m", "divideropt", "--help"],
            "check": ["-m", "divideropt", "check", str(campaign)],
            "import divideropt": ["-c", "import divideropt"],
        }
        print(f"{'':18}  {'clock':>7}  {'processor':>9}  limit    (best of {times}; {load()})")
        for name, call in calls.items():
            clock, processor = (min(values) for values in zip(*(measured(call) for _ in range(times)), strict=True))
            print(f"{name:18}  {clock:5.2f} s  {processor:7.2f} s  {LIMITS.get(name, '')}")
        print("\nwhat `check` imports, each library's own share [ms, with what measuring adds]:")
        dearest = sorted(shares(calls["check"]).items(), key=lambda item: item[1], reverse=True)
        for library, seconds in dearest[:SHOWN]:
            print(f"  {library:20} {1000 * seconds:5.0f}")


def load() -> str:
    """Say how busy the machine is."""
    return f"{os.getloadavg()[0]:.1f} processes at work on {os.cpu_count()} cores"


def measured(call: Sequence[str]) -> tuple[float, float]:
    """Run Python once; return seconds by the clock and of the processor."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([sys.executable, *call], check=True, capture_output=True)
    clock, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return clock, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def shares(call: Sequence[str]) -> dict[str, float]:
    """Return the seconds that importing each library takes by itself."""
    done = subprocess.run([sys.executable, "-X", "importtime", *call], check=True, capture_output=True, text=True)
    found: dict[str, float] = defaultdict(float)
    for line in done.stderr.splitlines():
        own, bar, rest = line.removeprefix("import time:").partition("|")
        if bar and own.strip().isdigit():
            found[rest.partition("|")[2].strip().partition(".")[0]] += int(own) * 1e-6
    return found


if __name__ == "__main__":
    main()
