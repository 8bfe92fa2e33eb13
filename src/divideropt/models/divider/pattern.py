"""Which state acts on which rate, and the order in which the linear systems of a step are eliminated."""

from collections.abc import Mapping
from types import MappingProxyType

PATTERN: Mapping[int, tuple[int, ...]] = MappingProxyType(
    {
        0: (0, 1, 2, 3, 4),
        1: (0, 1, 3, 6, 7),
        2: (0, 2, 4, 6, 8),
        3: (0, 1, 3, 5, 6),
        4: (0, 2, 4, 5, 6),
        5: (1, 2, 3, 4, 5, 6, 7, 8),
        6: (5,),
        7: (1, 6, 7),
        8: (2, 6, 8),
    }
)
"""The columns of each row of the Jacobian that can hold something else than zero, whatever the formulation."""

ORDER = (6, 7, 8, 3, 4, 1, 2, 0, 5)
"""The spool's position first, then the pressures from the loads and ends inwards, the velocity last.

It fills in eleven places. No pivoting is needed: every pressure leaks away into what its volume is joined to, so its
pivot stays above 1/(γh); the position's is 1/(γh) itself. The velocity's can vanish where the valve is unstable, for
single step sizes, at which any elimination fails; the step is then rejected.
"""
