"""How a pick-freeze sample is laid out.

A sample's blocks are those of `SALib.sample.sobol`: A, AB_1 … AB_d, [BA_1 … BA_d,] B. Design AB_i is A with variable
i taken from B, and BA_i is B with variable i taken from A.
"""

from dataclasses import dataclass
from itertools import combinations

from divideropt.models.base import FloatArray


@dataclass(frozen=True)
class Blocks:
    """How a pick-freeze sample is laid out.

    Attributes:
        variables: Their number d.
        second_order: Whether a block has BA_1 … BA_d, too.
    """

    variables: int
    second_order: bool

    @property
    def size(self) -> int:
        """Designs of a block."""
        return (2 if self.second_order else 1) * self.variables + 2

    @property
    def keys(self) -> list[tuple[str, int, int | None]]:
        """The indices in their order: kind, variable, and of a second-order one the other variable."""
        single: list[tuple[str, int, int | None]] = [
            (k, i, None) for k in ("S1", "ST") for i in range(self.variables)
        ]
        return single + [("S2", i, j) for i, j in self.pairs]

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """The pairs of variables that have a second-order index."""
        return list(combinations(range(self.variables), 2)) if self.second_order else []

    def ab(self, variable: int) -> int:
        """Place of AB_i in a block."""
        return 1 + variable

    def ba(self, variable: int) -> int:
        """Place of BA_i in a block."""
        return 1 + self.variables + variable

    @property
    def b(self) -> int:
        """Place of B in a block; A is the first."""
        return self.size - 1


def blocks_of(designs: FloatArray) -> Blocks:
    """Recognise the layout of a sample, shape (n, d), n at least one block.

    Raises:
        ValueError: It is no pick-freeze sample.
    """
    d = designs.shape[1]
    second = len(designs) > d + 1 and bool((designs[d + 1] == designs[0]).any())
    blocks = Blocks(d, second)
    if len(designs) < blocks.size:
        raise ValueError(f"{len(designs)} designs are less than one block, of {blocks.size}; sample more")
    first = designs[: blocks.size]
    for i in range(d):
        expected = first[0].copy()
        expected[i] = first[blocks.b, i]
        if (first[blocks.ab(i)] != expected).any():
            raise ValueError(f"design {blocks.ab(i)} is not the first with variable {i} of another: no Sobol sample")
    return blocks
