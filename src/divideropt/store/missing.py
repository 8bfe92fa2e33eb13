"""A folder that is no store: what it is, and which may have been meant."""

from difflib import get_close_matches
from pathlib import Path

FEW = 10
"""So many stores are named where one was looked for in their folder."""


def instead_of(folder: Path) -> str:
    """Say why a folder is no store, the end of a remark in brackets, and what to name instead."""
    if folder.is_file():
        return "it is a file); name the folder that `divideropt run` has made of a campaign: results/NAME"
    inside = sorted(path.parent.name for path in folder.glob("*/campaign.yaml"))
    if inside:
        return f"no campaign.yaml), but in it: {', '.join(inside[:FEW])}; name one of these"
    beside = [path.parent.name for path in folder.parent.glob("*/campaign.yaml")]
    meant = get_close_matches(folder.name, beside, n=1)
    hint = f"did you mean {folder.with_name(meant[0])}?" if meant else "name the folder of a store"
    return f"no campaign.yaml); {hint}"
