"""A picture for dark pages beside the one that a page names: `front-dark.png` beside `front.png`, where it is there.

The page stays plain Markdown, which other readers show with its light picture.
"""

from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform
from sphinx.util.typing import ExtensionMetadata


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the transformation."""
    app.add_transform(_DarkPictures)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}


class _DarkPictures(SphinxTransform):
    """Put a picture's dark companion behind it; the theme shows one of them (`only-light`, `only-dark`)."""

    default_priority = 500

    def apply(self, **_kwargs: object) -> None:
        folder = Path(self.document["source"]).parent
        for image in list(self.document.findall(nodes.image)):
            path = Path(image["uri"])
            dark = path.with_stem(f"{path.stem}-dark")
            if not (folder / dark).is_file():
                continue
            companion = image.deepcopy()
            companion["uri"] = dark.as_posix()
            image["classes"].append("only-light")
            companion["classes"].append("only-dark")
            image.parent.insert(image.parent.index(image) + 1, companion)
