"""The author's sweeps again, by `divideropt sensitivity`: how far our error and source pressure are from his code's.

Run it with `python benchmarks/listing_sensitivity.py`; it takes some seconds. The data is in
`tests/reference/listing_sensitivity.csv`, whose README says how it was made.

His error is |QL1 - QL2|/Qs, the magnitude of (3.5), which we call `flow_difference`. Our `steady_state_error` is
(3.6) to the letter: the same number where one load gets more than it should and the other less. Where both get less,
for leakage, it is the leakage's share of the source flow, and that is another number than his.
"""

import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from divideropt.models.divider.study import LISTING_NAMES

HERE = Path(__file__).parent
CAMPAIGN = HERE / "listing_sensitivity.yaml"
REFERENCE = HERE.parent / "tests" / "reference" / "listing_sensitivity.csv"

SOLVED = 2
"""The status of a design that his solver completed."""

SOURCE_FLOW = 1e-3
"""Of his test [m^3/s]."""


@dataclass(frozen=True)
class Agreement:
    """How far we are from him along one parameter.

    Attributes:
        parameter: Its name.
        designs: Of his sweep.
        unsolved: Those that his solver did not complete; they are not compared.
        outcomes: How ours ended, by outcome, where not ok; they are compared.
        flow_difference: Largest relative difference of (3.5), with its sign.
        error: Largest relative difference of its magnitude, his error.
        source_pressure: Largest relative difference.
        other: Designs at which (3.6) is another number than |(3.5)|: both loads get less than they should.
        stated: Largest relative difference of (3.6) to his error at the other designs.
        leaking: Largest difference of (3.6) at `other` from the leakage's share of the source flow [%]; 0 if none.
    """

    parameter: str
    designs: int
    unsolved: int
    outcomes: Mapping[str, int]
    flow_difference: float
    error: float
    source_pressure: float
    other: int
    stated: float
    leaking: float


def main() -> None:
    """Run the study and print how far it is from his."""
    with tempfile.TemporaryDirectory() as folder:
        found = agreement(run(Path(folder)))
    print("largest relative differences of his error |(3.5)|, of (3.5), of the source pressure and of (3.6)")
    for a in found:
        figures = " ".join(f"{v:9.1e}" for v in (a.error, a.flow_difference, a.source_pressure, a.stated))
        notes = [f"{a.designs - a.unsolved} designs compared"]
        notes += [f"{count} of ours {name}" for name, count in a.outcomes.items()]
        notes += [f"(3.6) is another number at {a.other}"] if a.other else []
        print(f"{a.parameter:20} {figures}   {'; '.join(notes)}")
    designs, unsolved = sum(a.designs for a in found), sum(a.unsolved for a in found)
    print(f"his solver completed {designs - unsolved} of {designs} designs")
    leaking = max(a.leaking for a in found)
    print(f"(3.6) is another number where both loads get less than half: the leakage's share, within {leaking:.1e} %")


def run(store: Path) -> pd.DataFrame:
    """Run the study by its command and return its evaluations, in their order."""
    command = [sys.executable, "-m", "divideropt", "sensitivity", str(CAMPAIGN), "--method", "oat"]
    subprocess.run([*command, "--store", str(store / "store")], check=True, capture_output=True)
    return pd.read_parquet(store / "store" / "sensitivity" / "oat" / "evaluations" / "oat-1")


def agreement(ours: pd.DataFrame) -> list[Agreement]:
    """Compare the study with his sweeps.

    Args:
        ours: Its evaluations: one batch a parameter, in the campaign's order.

    Raises:
        ValueError: His values of a parameter are not ours.
    """
    theirs = pd.read_csv(REFERENCE)
    found = []
    for batch, (column, name) in enumerate(LISTING_NAMES.items()):
        his = theirs[theirs["param"] == column].reset_index(drop=True)
        mine = ours[ours["batch"] == batch].reset_index(drop=True)
        if len(his) != len(mine) or not np.allclose(his["value"], mine[name], rtol=1e-12, atol=0.0):
            raise ValueError(f"{name}: batch {batch} of the study is not his sweep")
        found.append(_compared(name, his, mine))
    return found


def _compared(name: str, his: pd.DataFrame, mine: pd.DataFrame) -> Agreement:
    solved = his["istate"] == SOLVED
    failed = mine["outcome"][mine["outcome"] != "ok"].value_counts()
    his, mine = his[solved], mine[solved]
    share = mine["leakage"] / SOURCE_FLOW * 100.0
    other = share > mine["flow_difference"].abs()
    return Agreement(
        parameter=name,
        designs=len(solved),
        unsolved=int((~solved).sum()),
        outcomes={str(outcome): int(count) for outcome, count in failed.items()},
        flow_difference=_off(mine["flow_difference"], his["sserr"]),
        error=_off(mine["flow_difference"].abs(), his["abs_sserr"]),
        source_pressure=_off(mine["source_pressure"], his["ssPs"]),
        other=int(other.sum()),
        stated=_off(mine["steady_state_error"][~other], his["abs_sserr"][~other]),
        leaking=float((mine["steady_state_error"] - share)[other].abs().max()) if other.any() else 0.0,
    )


def _off(mine: pd.Series, his: pd.Series) -> float:
    """Largest relative difference; NaN where one of ours is not defined."""
    return float(np.max(np.abs(mine.to_numpy() / his.to_numpy() - 1.0)))


if __name__ == "__main__":
    main()
