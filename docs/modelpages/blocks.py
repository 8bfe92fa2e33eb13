"""Text between two markers of a page, `<!-- begin NAME -->` and `<!-- end NAME -->`."""

import re
from collections.abc import Mapping


def fill(page: str, blocks: Mapping[str, str]) -> str:
    """Put new text between markers.

    Args:
        page: The page.
        blocks: The text of each block by its name, without the markers.

    Returns:
        The page with the blocks exchanged and all else as it was.

    Raises:
        ValueError: A block has no pair of markers in the page, or more than one.
    """
    for name, text in blocks.items():
        found = list(_between(name).finditer(page))
        if len(found) != 1:
            raise ValueError(f"block {name!r} has {len(found)} pairs of markers; the page must have one")
        page = f"{page[: found[0].start(2)]}\n{text}\n{page[found[0].end(2) :]}"
    return page


def block(page: str, name: str) -> str:
    """Return the text between the markers of a name."""
    match = _between(name).search(page)
    if match is None:
        raise ValueError(f"block {name!r} has no pair of markers")
    return match[2].strip("\n")


def _between(name: str) -> re.Pattern[str]:
    return re.compile(rf"(<!-- begin {re.escape(name)} -->)(.*?)(<!-- end {re.escape(name)} -->)", re.DOTALL)
