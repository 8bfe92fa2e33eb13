"""Colours and marks: Okabe and Ito's palette, and a shape a strategy besides."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""In figures; the page exchanges each for its own `--series-N`, which stands out from the paper, light or dark, and
is told from the others with any colour vision (`tests/report/test_colours.py` says how far)."""

_SHAPES = ("circle", "diamond", "square", "cross", "x", "circle-open")  # those that plotly has in 3-D, too

DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
"""One a seed, so that runs of one strategy are told apart."""


@dataclass(frozen=True)
class Mark:
    """How a strategy is drawn.

    Attributes:
        place: Index of its colour in `COLOURS`.
        shape: Its marker, by plotly's name.
        opacity: Of its markers.
    """

    place: int
    shape: str
    opacity: float = 0.8

    @property
    def colour(self) -> str:
        """Its colour."""
        return COLOURS[self.place]


@dataclass(frozen=True)
class Stroke:
    """How a response is drawn: colour, dash by plotly's name, width [px]."""

    colour: str
    dash: str
    width: float


def marks(strategies: Sequence[str]) -> dict[str, Mark]:
    """Give each strategy a colour and a shape, in order."""
    return {name: Mark(i % len(COLOURS), _SHAPES[i % len(_SHAPES)]) for i, name in enumerate(strategies)}


SELECTED_STROKE = Stroke(COLOURS[1], "solid", 3.0)
"""That of the design that is shown closely."""

OTHERS_STROKE = Stroke(COLOURS[1], "solid", 1.0)
"""Those of the others selected."""

SET_STROKES: Mapping[str, Stroke] = MappingProxyType(
    {
        "thesis_base": Stroke(COLOURS[0], "dot", 2.0),
        "thesis_prototype": Stroke(COLOURS[3], "dashdot", 2.0),
        "thesis_optimum": Stroke(COLOURS[2], "dash", 2.0),
    }
)
"""Those of the thesis's parameter sets."""
