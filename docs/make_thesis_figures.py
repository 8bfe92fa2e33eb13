"""The figures of Chapters 2 and 3 of the thesis drawn again, and twins of three of Chapter 4, with a verdict each.

Run it with `python docs/make_thesis_figures.py`; it takes about a minute on one core. It writes
`docs/model/figures.md` and `docs/images/thesis/*.svg`. Running it twice gives the same bytes.
"""

from pathlib import Path

from thesisfigures.catalogue import FIGURES
from thesisfigures.figure import both_runs
from thesisfigures.page import page

HERE = Path(__file__).parent
PAGE, PICTURES = HERE / "model" / "figures.md", HERE / "images" / "thesis"


def main() -> None:
    """Draw and judge each figure, then write the page."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    both, rows = both_runs(), {}
    for figure in FIGURES:
        (PICTURES / figure.file).write_text(figure.draw(both), encoding="utf-8")
        print(PICTURES / figure.file, flush=True)
        rows[figure.number] = figure.judge(both)
    PAGE.write_text(page(rows, both), encoding="utf-8")
    print(PAGE)


if __name__ == "__main__":
    main()
