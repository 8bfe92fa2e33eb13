"""What the slip in the listing's leakage makes of the clearance: the listing, run with that one sign mended."""

from dataclasses import replace

from claims.runs import RANGES, RTOL
from divideropt.models.divider import FORMULATIONS, QUANTITIES, Scenario, parameter_set, solver_settings
from divideropt.models.divider.formulations import Formulation
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.response import respond


def leakage_note() -> str:
    """Say what mending the sign of Qlb2 changes over the author's range of clearances."""
    listing = FORMULATIONS["listing"]
    printed, mended = (_errors(f) for f in (listing, replace(listing, mirrored_leakage=True)))
    return (
        "A slip makes this finding. In the listing, the leakage `Qlb2` of side 2 has a minus where side 1 has a "
        f"plus, so that fluid appears from nowhere. As it ran, the error goes from {printed[0]:.2f} % at 1 µm to "
        f"{printed[1]:.2f} % at 20 µm; with that one sign mended, and nothing else, from {mended[0]:.2f} % to "
        f"{mended[1]:.2f} %. The `text` has no leakage to tank at all: the "
        "printed pilot equations themselves make what its flows have too much."
    )


def _errors(formulation: Formulation) -> list[float]:
    """Return the steady-state error [%] at both ends of the range of clearances, standard test, settled."""
    place = list(QUANTITIES).index("steady_state_error")
    errors = []
    for clearance in RANGES["radial_clearance"]:
        design = parameter_set("thesis_base") | {"radial_clearance": clearance}
        row, _ = measure(respond(design, formulation, Scenario(), solver_settings("LSODA", RTOL)))
        errors.append(float(row[place]))
    return errors
