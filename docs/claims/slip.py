"""What the slip in the listing's leakage makes of the clearance: the listing, run with that one sign mended."""

from dataclasses import replace

from modelpages.runs import Run, run

from divideropt.models.divider import FORMULATIONS, parameter_set
from divideropt.models.divider.formulations import Formulation
from divideropt.models.divider.study import THESIS_RANGES


def leakage_note() -> str:
    """Say what mending the sign of Qlb2 changes over the author's range of clearances."""
    listing = FORMULATIONS["listing"]
    tight, wide = _ends(listing)
    mended_tight, mended_wide = _ends(replace(listing, mirrored_leakage=True))
    return (
        "A slip makes this finding. In the listing, the leakage `Qlb2` of side 2 has a minus where side 1 has a "
        "plus, so that the two end chambers leak unequally and the spool is pushed aside: at 20 µm the flows differ "
        f"by {wide['ratio_bias']:.2f} % before the step, with equal loads. As it ran, the error goes from "
        f"{tight['steady_state_error']:.2f} % at 1 µm to {wide['steady_state_error']:.2f} % at 20 µm; with that one "
        f"sign mended, and nothing else, from {mended_tight['steady_state_error']:.2f} % to "
        f"{mended_wide['steady_state_error']:.2f} %, and by {abs(mended_wide['ratio_bias']):.2f} % before the step. "
        "The fluid from nowhere is another matter: it comes from the sign of (A.1) and the lost particular solution; "
        f"with the sign of `Qlb2` mended it is {_nowhere(mended_wide)} instead of {_nowhere(wide)} m³/s at 20 µm. "
        "The `text` has no leakage to tank at all: the printed pilot equations themselves make what its flows have "
        "too much."
    )


def _nowhere(end: Run) -> str:
    """Write the fluid from nowhere [10⁻⁵ m³/s]."""
    return f"{1e5 * end.fluid_from_nowhere:.1f}×10⁻⁵"


def _ends(formulation: Formulation) -> tuple[Run, Run]:
    """Run both ends of the range of clearances, standard test, settled."""
    low, high = (
        run(parameter_set("thesis_base") | {"radial_clearance": clearance}, formulation)
        for clearance in THESIS_RANGES["radial_clearance"]
    )
    return low, high
