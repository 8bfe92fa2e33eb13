"""The author's own results again: his 152 designs through `divideropt evaluate`, his responses, his derivatives.

Run it with `python benchmarks/reproduce_listing.py`; it takes half a minute. The data is in `tests/reference`, whose
README says how it was made.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from divideropt.models.divider import Divider, Scenario, load_step, parameter_set, solver_settings

HERE = Path(__file__).parent
REFERENCE = HERE.parent / "tests" / "reference"
NAMES = {
    "id": "design_id",
    "r": "spool_radius",
    "b": "groove_width",
    "deltaPt": "total_pressure_drop",
    "Po_Pt": "fixed_drop_ratio",
    "frac_open": "centred_opening",
    "rsr": "stem_ratio",
}
STATES = ["Ps", "Pa1", "Pa2", "Pb1", "Pb2", "xdot", "x", "PL1", "PL2"]


def main() -> None:
    """Print how far our results are from his."""
    objectives()
    responses()


def objectives() -> None:
    """Evaluate his designs by the command and compare steady-state error and source pressure."""
    theirs = pd.read_csv(REFERENCE / "listing_objectives.csv")
    with tempfile.TemporaryDirectory() as folder:
        asked, answered = Path(folder, "designs.csv"), Path(folder, "out.parquet")
        theirs[list(NAMES)].rename(columns=NAMES).to_csv(asked, index=False)
        campaign = str(HERE / "listing.yaml")
        command = [sys.executable, "-m", "divideropt", "evaluate", str(asked), "--campaign", campaign]
        subprocess.run([*command, "--out", str(answered)], check=True)
        ours = pd.read_parquet(answered)
    solved = theirs.istate == 2
    print(f"{len(theirs)} designs; the author's solver completed {solved.sum()}, of which we complete "
          f"{(ours.outcome[solved] != 'not_completed').sum()}")  # fmt: skip
    print(f"outcomes where his solver did not: {ours.outcome[~solved].value_counts().to_dict()}")
    agree = ((ours.outcome == "at_stop") == (theirs.at_stop == 1))[solved].all()
    print(f"the same designs at the stop: {agree}")
    for name, mine, his in (
        ("steady_state_error", ours.steady_state_error, theirs.sserr.abs()),
        ("flow_difference", ours.flow_difference, theirs.sserr),
        ("source_pressure", ours.source_pressure, theirs.ssPs),
    ):
        off = (mine / his - 1).abs()[solved]
        print(f"{name:20} largest relative difference {off.max():.1e}, median {off.median():.1e}")


def responses() -> None:
    """Compare the states of his three responses."""
    for name, parameters, step in (
        ("base_divfitag", "thesis_base", 0.05),
        ("base_changeall", "thesis_base", 0.6),
        ("tab33_divfitag", "thesis_optimum", 0.05),
    ):
        theirs = pd.read_csv(REFERENCE / f"listing_response_{name}.csv")
        scenario = Scenario(settled=False, events=(load_step(1, 15e6, at=step),))
        model = Divider("listing", scenario, solver_settings("LSODA", 1e-10))
        response = model.respond(parameter_set(parameters))
        early, late = (p.trajectory for p in response.phases if p.trajectory is not None)
        t = theirs.t.to_numpy()
        states = np.where((t <= step)[:, None], early.at(np.minimum(t, step)), late.at(np.maximum(t, step)))
        his = theirs[STATES].to_numpy()
        off = np.abs(states - his).max(axis=0) / np.ptp(his, axis=0)
        print(f"{name:20} worst state {STATES[int(off.argmax())]}: {off.max():.1e} of its range")


if __name__ == "__main__":
    main()
