"""The records in which compiled functions give what they have measured and how they judge it."""

import numpy as np

from divideropt.models.divider.quantities import EVENT_QUANTITIES, QUANTITIES

WHOLE_QUANTITIES = tuple(name for name in QUANTITIES if name not in EVENT_QUANTITIES)
"""The quantities that a response has once, whatever its events."""

WHOLE = np.dtype((np.record, [(name, "f8") for name in WHOLE_QUANTITIES]))
"""Those of one response."""

BY_EVENT = np.dtype((np.record, [(name, "f8") for name in EVENT_QUANTITIES]))
"""Those that each event has."""

JUDGEMENT = np.dtype(
    (
        np.record,
        [
            ("finding", "i8"),  # a number of `FINDINGS`
            ("phase", "i8"),  # where
            ("value", "f8"),  # what its sentence speaks of
        ],
    )
)
"""How one response is judged."""

(
    SOUND,
    NOT_COMPLETED,
    LIMIT_CYCLE,
    AT_STOP,
    NO_EQUILIBRIUM,
    UNSTABLE,
    UNSETTLED,
    LEFT_ITS_BAND,
    NOT_FOLLOWED,
) = FINDINGS = range(9)
"""What can be found wrong, the gravest first; LEFT_ITS_BAND is how a response that ends anywhere is unsettled, and
NOT_FOLLOWED says that the compiled loop must leave the design to the slower way."""
