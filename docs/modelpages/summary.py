"""What the options of the page of disagreements come to, in sentences with the tables' own numbers."""

from modelpages.options import FROM_CONSERVATIVE, PARAMETERS, WHOLE
from modelpages.tables import fixed, power

READINGS = {reading.label: reading for reading in (*WHOLE, *FROM_CONSERVATIVE)}
PILOTS = [label for label in READINGS if label.startswith("pilot stage")]


def in_short() -> str:
    """Say what decides the steady-state error, and what the pilot stage's slips do to it."""
    whole = _error("**`conservative`**")
    slips = max(abs(_error(label) - whole) for label in PILOTS)
    listing = READINGS["**`listing`**"].run(PARAMETERS["wide"])
    made = 100 * listing.fluid_from_nowhere / listing.response.scenario.source_flow
    narrow = f"{PARAMETERS['base']['radial_clearance'] * 1e6:g} µm"
    wide = f"{PARAMETERS['wide']['radial_clearance'] * 1e6:g} µm"
    return (
        "- **Flow force and holes decide.** A port has two holes in the code and one in the printed equations. "
        "With one rim instead of two the base set's steady-state error\n"
        f"  falls from {fixed(whole, 1)} to {fixed(_error('one hole in (2.18)'), 1)} %. "
        "Forgetting one hole in half of (2.15), as the code does, takes it to "
        f"{fixed(_error('one hole in the second term of (2.15)'), 1)} %, the printed end area to "
        f"{fixed(_error('end area π r²'), 1)} %,\n"
        f"  and one hole in the whole of (2.15), as printed, makes it {fixed(_error('one hole in (2.15)'), 1)} %. "
        "No other option comes near.\n"
        f"- **The pilot stage's slips make fluid.** At the base set's clearance of {narrow} that hardly shows in the "
        f"flows: the steady-state error moves by {power(slips, 0)} percentage points at\n"
        f"  most. At {wide} the code makes {fixed(made, 1)} % of the source flow out of nothing, and its "
        f"steady-state error rises from {fixed(_error('**`listing`**'), 1)} to "
        f"{fixed(listing['steady_state_error'], 1)} %. **Figure 3.11, tighter clearance\n"
        "  buys steady-state accuracy, is made by these slips**; with the physics right the error does not rise with "
        f"the clearance, it falls from {fixed(whole, 2)} to {fixed(_error('**`conservative`**', 'wide'), 2)} %."
    )


def _error(label: str, design: str = "base") -> float:
    return READINGS[label].run(PARAMETERS[design])["steady_state_error"]
