"""The numbers and figures of `docs/model/`, from the model's own runs.

Run it with `python docs/make_model_pages.py`; it takes a minute or two. Tables go between the markers of the pages,
figures to `docs/images/model/`. Running it twice gives the same bytes.
"""

from collections.abc import Callable, Mapping
from pathlib import Path

from modelpages import (
    closed_form,
    designs,
    endflows,
    grooves,
    kwan,
    limits,
    measures,
    nomenclature,
    options,
    starts,
    summary,
    turned,
)
from modelpages.blocks import fill
from modelpages.figures import FIGURES, figure_2_6_caption

PAGES = Path(__file__).parent / "model"
PICTURES = Path(__file__).parent / "images" / "model"

BLOCKS: Mapping[str, Mapping[str, Callable[[], str]]] = {
    "nomenclature.md": {
        "parameters": nomenclature.parameters_table,
        "sets": nomenclature.sets_table,
        "quantities": nomenclature.quantities_table,
    },
    "pilot.md": {
        "closed-form": closed_form.closed_form_table,
        "validity": grooves.validity_table,
        "groove-loss": grooves.groove_loss_table,
    },
    "disagreements.md": {
        "in-short": summary.in_short,
        "options-base": lambda: options.options_table((*options.WHOLE, *options.FROM_CONSERVATIVE), "base"),
        "options-wide": lambda: options.options_table((*options.WHOLE, *options.FROM_CONSERVATIVE), "wide"),
        "options-prototype": lambda: options.options_table((*options.WHOLE, *options.FROM_CONSERVATIVE), "prototype"),
        "listing-mended": lambda: options.options_table((options.WHOLE[-1], *options.FROM_LISTING), "wide"),
        "end-flows": endflows.end_flows_table,
        "limits": lambda: limits.limits_table(128),
        "sizing": designs.sizing_table,
        "kwan": kwan.kwan_table,
        "drawn": designs.drawn_table,
        "starts": lambda: starts.starts_table("listing"),
        "measures": measures.measures_table,
        "rotated": measures.rotated_table,
        "turned": turned.turned_table,
        "figure-2-6": figure_2_6_caption,
        "cancelling": lambda: measures.cancelling_table(256),
    },
}
"""What writes each block of each page."""


def main() -> None:
    """Write all of it."""
    for page, blocks in BLOCKS.items():
        path = PAGES / page
        path.write_text(fill(path.read_text("utf-8"), {name: make() for name, make in blocks.items()}), "utf-8")
        print(path)
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name, make in FIGURES.items():
        path = PICTURES / f"{name}.svg"
        path.write_text(make(), "utf-8")
        print(path)


if __name__ == "__main__":
    main()
