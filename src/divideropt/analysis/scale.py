"""Objectives made comparable: from the ideal to the nadir point of a front, 0 to 1."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray


def region(front: FloatArray, reference: FloatArray | None) -> NDArray[np.bool_]:
    """Mark the part of a front by which to scale: what is within the reference point, as for the hypervolume.

    Fronts have tails that nobody looks at, and their extents would make all else small.

    Args:
        front: Non-dominated points, shape (n, k), to be minimised.
        reference: The reference point, shape (k,), or None.

    Returns:
        Shape (n,); all, where there is no reference point, or where within it some objective has no extent.
    """
    everything = np.ones(len(front), dtype=bool)
    if reference is None:
        return everything
    inside = np.asarray((front <= reference).all(axis=1))
    enough = inside.any() and bool((Scale.of(front[inside]).extent > 0.0).all())
    return inside if enough else everything


@dataclass(frozen=True)
class Scale:
    """A front's extents.

    Attributes:
        ideal: The least value of each objective, shape (k,).
        extent: Its largest value above that, shape (k,); 0 where all points have the same.
    """

    ideal: FloatArray
    extent: FloatArray

    @classmethod
    def of(cls, front: FloatArray) -> "Scale":
        """Measure a front of non-dominated points, shape (n, k), n at least 1."""
        ideal = front.min(axis=0)
        return cls(ideal, front.max(axis=0) - ideal)

    @property
    def divisor(self) -> FloatArray:
        """The extents, 1 where there is none, shape (k,)."""
        return np.where(self.extent > 0.0, self.extent, 1.0)

    def apply(self, F: FloatArray) -> FloatArray:
        """Scale points, shape (n, k): the front's lie between 0 and 1."""
        return np.asarray((F - self.ideal) / self.divisor)
