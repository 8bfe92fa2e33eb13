"""What a loss in the line to the pilot stage does to the ideal ratio: what section 4.7 says of the rig."""

from scipy.optimize import brentq

SHARES = (0.0, 0.25, 0.5)
"""Losses of the line over the drop at a fixed orifice, flows equal. The rig's is not stated."""


def ratio_with_line_loss(spool_position: float, share: float) -> float:
    """Return QL1/QL2 of the ideal valve (2.6) when the pilot stage sees the source pressure less a loss.

    The spool rests where ρ (Δ1 - L) = (1 - ρ) (Δ2 - L), with ρ = φ/φ0, Δi = Ps - Pai and equal fixed orifices, whose
    flows go with the root of Δi and add up to the source flow.

    Args:
        spool_position: ρ, strictly between 0 and 1.
        share: L over the drop that either orifice has when the flows are equal.
    """

    def imbalance(first: float) -> float:
        return spool_position * (first**2 - share) - (1 - spool_position) * ((2 - first) ** 2 - share)

    first = float(brentq(imbalance, 0.0, 2.0, xtol=1e-14))
    return first / (2 - first)
