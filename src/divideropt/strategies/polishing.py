"""Goal-attainment polishing: which designs to evaluate next, by models of what is known around front members."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace, Told
from divideropt.strategies.archive import Archive, Scale
from divideropt.strategies.local_model import LocalModel, points_wanted

LEAST_GAIN = 2e-3
"""Predicted relative fall of a direction's λ below which a design is not worth an evaluation."""

RESOLUTION = 2e-3
"""Designs nearer to an evaluated one than this part of the box in every variable are not evaluated."""

SMALLEST_REACH, LARGEST_REACH = 5e-3, 0.5
"""Between these parts of the box a step is held. The first from a front member is held to the radius of its model;
from what has gained a step reaches twice as far, from what has failed to gain half as far."""

NARROWEST = 1e-2
"""Least radius of a model, as a part of the box: nearer designs tell more of the noise than of the slopes."""

VIOLATION_FITTED = 1.0
"""Violations are fitted up to this relative size: beyond, they say little of where a constraint is met."""

CREDIBLE_GAIN = 1e-4
"""Relative fall of λ that counts as one."""


@dataclass(frozen=True)
class Visit:
    """Why a design was proposed.

    Attributes:
        member: The front member it set out from, shape (d,), in parts of the box.
        reach: How far it was allowed to go, in parts of the box.
        direction: Shape (k,).
        attained: λ of the member in that direction.
    """

    member: FloatArray
    reach: float
    direction: FloatArray
    attained: float


class Polisher:
    """Knows every design that could be simulated, and how far steps from front members may go."""

    def __init__(self, space: DesignSpace) -> None:
        """Begin with nothing known."""
        self._space = space
        self._width = space.upper - space.lower
        self._known = np.empty((0, len(space)))
        self._F: list[FloatArray] = []
        self._G: list[FloatArray] = []
        self._reaches: dict[bytes, float] = {}

    def hear(self, designs: FloatArray, told: Told) -> None:
        """Learn of evaluated designs; failed ones have no values to fit."""
        ok = told.G[:, 0] <= 0.0
        self._known = np.concatenate([self._known, self._parts(designs[ok])])
        self._F.append(told.F[ok])
        self._G.append(np.clip(told.G[ok, 1:], -VIOLATION_FITTED, VIOLATION_FITTED))

    def propose(
        self, archive: Archive, scale: Scale, directions: FloatArray, most: int
    ) -> tuple[FloatArray, list[Visit]]:
        """Find designs that promise to attain a direction's goals better than what is known, and are new.

        Args:
            archive: Holds the front.
            scale: Makes its objectives comparable.
            directions: Weights, shape (m, k), in the order of preference.
            most: Most designs.

        Returns:
            Designs, shape (n, d), in the variables' units, n ≤ most, and why each was chosen.
        """
        designs: list[FloatArray] = []
        visits: list[Visit] = []
        if len(self._known) > points_wanted(len(self._space)):
            for design, visit in self._promising(archive, scale, directions):
                if designs and _nearest(np.array(designs).T, design) < RESOLUTION:
                    continue
                designs.append(design)
                visits.append(visit)
                if len(designs) == most:
                    break
        found = np.array(designs).reshape(-1, len(self._space))
        return self._space.clip(self._space.lower + found * self._width), visits

    def learn(self, designs: FloatArray, told: Told, scale: Scale, visits: list[Visit]) -> None:
        """Reach further from what has gained, and less far from where a step did not."""
        scaled = scale.of(told.F)
        for design, values, feasible, visit in zip(self._parts(designs), scaled, told.feasible, visits, strict=True):
            attained = (values / visit.direction).max()
            if feasible and attained < visit.attained * (1.0 - CREDIBLE_GAIN):
                self._reaches[design.tobytes()] = min(2.0 * visit.reach, LARGEST_REACH)
            else:
                self._reaches[visit.member.tobytes()] = max(0.5 * visit.reach, SMALLEST_REACH)

    def _promising(
        self, archive: Archive, scale: Scale, directions: FloatArray
    ) -> Iterator[tuple[FloatArray, Visit]]:
        F, G = np.concatenate(self._F), np.concatenate(self._G)
        self._F, self._G = [F], [G]
        values = np.concatenate([np.log(scale.of(F)), G], axis=1)
        front, members = np.ascontiguousarray(scale.of(archive.F).T), self._parts(archive.X)
        known = np.ascontiguousarray(self._known.T)
        wanted = points_wanted(len(self._space))
        for direction in directions:
            attained = (front / direction[:, None]).max(axis=0)
            row = int(attained.argmin())
            member = members[row]
            distances = np.abs(known - member[:, None]).max(axis=0)
            near = np.argpartition(distances, wanted)[:wanted]
            radius = max(float(distances[near].max()), NARROWEST)
            reach = min(self._reaches.get(member.tobytes(), radius), radius)
            model = LocalModel.fitted(member, radius, self._known[near], values[near])
            design, gain = model.step(direction, reach)
            if gain >= LEAST_GAIN and _nearest(known, design) >= RESOLUTION:
                yield design, Visit(member, reach, direction, float(attained[row]))

    def _parts(self, designs: FloatArray) -> FloatArray:
        """Designs as parts of the box."""
        return np.asarray((designs - self._space.lower) / self._width)


def _nearest(known: FloatArray, design: FloatArray) -> float:
    """Return the distance from a design, shape (d,), to the nearest of those known, shape (d, n)."""
    return float(np.abs(known - design[:, None]).max(axis=0).min())
