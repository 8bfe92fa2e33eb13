"""How Sphinx builds the pages: `poe docs`, into `build/docs`."""

import re
import sys
from pathlib import Path

from sphinx.application import Sphinx

sys.path.insert(0, str(Path(__file__).parent))

project = "divideropt"
author = "the developers of divideropt"
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_click",
    "mathml",
    "campaignkeys",
    "darkpictures",
]
add_module_names = False
default_role = "code"
nitpicky = True
nitpick_ignore_regex = [
    ("py:.*", r"(collections\.abc|datetime|enum|numpy|pandas|pathlib|plotly|pyarrow|typing)\..*"),
    ("py:class", "FloatArray|BoolArray"),
]
"""Names of other packages, whose pages are on the network; ours must all resolve."""

highlight_language = "none"
html_theme = "furo"
html_title = "divideropt"
html_static_path = ["static"]
html_css_files = ["pages.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_search_summary = False  # fetched, which a page opened from the disk may not
html_show_copyright = False

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False

_ARRAYS = {"float64": "FloatArray", "bool": "BoolArray"}


def setup(app: Sphinx) -> None:
    """Let signatures say arrays by their short names, and attributes be described by whole sentences."""
    app.connect("autodoc-process-signature", _short_arrays)
    app.connect("autodoc-process-docstring", _whole_sentences, priority=400)  # before napoleon's


def _short_arrays(
    _app: Sphinx, _what: str, _name: str, _obj: object, _options: object, signature: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    return _shortened(signature), _shortened(returned)


def _whole_sentences(_app: Sphinx, what: str, _name: str, _obj: object, _options: object, lines: list[str]) -> None:
    """Give napoleon an empty type, where it would take what stands before a colon for one: annotations have them."""
    if what in ("attribute", "data", "property") and lines:
        lines[0] = f": {lines[0]}"


def _shortened(text: str | None) -> str | None:
    if text is None:
        return None
    pattern = r"~?numpy\.ndarray\[tuple\[(?:~?typing\.)?Any, \.\.\.\], ~?numpy\.dtype\[~?numpy\.(float64|bool)_?\]\]"
    return re.sub(pattern, lambda found: _ARRAYS[found[1]], text)
