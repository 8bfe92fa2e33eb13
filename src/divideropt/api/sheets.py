"""A design's dimension sheet; `divideropt sheet`."""

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from divideropt.api.given import Design, Given, campaign_given, listen, setting
from divideropt.api.stores import Results
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_model
from divideropt.campaign.sheet import Sheet, sheet_table, sheet_yaml
from divideropt.campaign.sheet import sheet as sheet_of
from divideropt.errors import UsageError
from divideropt.report import sheet_svg, sheet_text
from divideropt.store import Store
from divideropt.store.files import publish


@dataclass(frozen=True)
class DimensionSheet:
    """A design's dimensions, and with a step the same rounded, each simulated."""

    found: Sheet
    """What `divideropt.campaign.sheet` returned."""

    def __str__(self) -> str:
        """Return the table that the command prints."""
        return sheet_text(self.found)

    def _repr_svg_(self) -> str:
        """Return the drawing, which a notebook shows."""
        return self.svg

    @property
    def table(self) -> pd.DataFrame:
        """A row a line in SI: section, name, symbol, unit, exact, rounded (with a step), note."""
        return sheet_table(self.found)

    @property
    def rounded(self) -> dict[str, float]:
        """Every parameter of the rounded design by name, or without a step of the design; SI."""
        return dict(self.found.columns[-1].parameters)

    @property
    def feasible(self) -> bool:
        """Whether the rounded design, or without a step the design, keeps every constraint."""
        return self.found.columns[-1].feasible

    @property
    def svg(self) -> str:
        """The design drawn to scale, with the table."""
        return sheet_svg(self.found)

    def write(self, out: Path | str) -> Path:
        """Write the table (.csv), the drawing (.svg), or the design as a campaign's `set:` (.yaml).

        Raises:
            UsageError: The name ends otherwise.
            DiskError: The disk refused.
        """
        path = Path(out)
        if path.suffix not in (".csv", ".svg", ".yaml"):
            raise UsageError(f"{path}: the name must end in .csv, .svg or .yaml")
        if path.suffix == ".csv":
            text = self.table.to_csv(index=False)
        else:
            text = self.svg if path.suffix == ".svg" else sheet_yaml(self.found)
        publish(path, lambda staged: staged.write_text(text, encoding="utf-8"))
        return path


def sheet(
    source: Results | Given | None = None,
    design: str | None = None,
    *,
    set: Design | None = None,
    step: str | None = None,
) -> DimensionSheet:
    """List a design's dimensions, and with a step what it does when they are rounded; `divideropt sheet`.

    Args:
        source: A store (its folder, or what `run` or `open` returned), or a campaign; the one that ships with the
            package where not given.
        design: Of a store, which of its designs: `<run>/<index>`.
        set: Parameters that differ.
        step: To multiples of what the dimensions are rounded, `0.1 mm`; not at all where not given.

    Returns:
        The sheet; a design that fails has an outcome that says so.

    Raises:
        UsageError: There is no such design, a name is no parameter, or so rounded there is no such valve.
        FileMistakes: Everything wrong in the campaign, with line and column.
        StoreError: The store is damaged.
    """
    listen()
    given = source.folder if isinstance(source, Results) else source
    folder = _folder(given)
    campaign = campaign_given(given) if folder is None else stored_campaign(Store(folder))
    known = build_model(campaign).parameters
    settings = [setting(name, value, known) for name, value in (set or {}).items()]
    return DimensionSheet(sheet_of(campaign if folder is None else folder, design, settings, step))


def _folder(source: Given | None) -> Path | None:
    """Return the folder that was given, or None where it is a campaign."""
    if not isinstance(source, Path | str) or "\n" in str(source):
        return None
    return Path(source) if Path(source).is_dir() else None
