"""Formulas as MathML, which browsers draw themselves: no script, and no network to fetch one from."""

import re

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.typing import ExtensionMetadata
from sphinx.writers.html5 import HTML5Translator

_TAG = re.compile(r"\\tag\{(.*?)\}")

_SPELLINGS = {r"\\lt\b": "<", r"\\gt\b": ">", r"\\[bB]igg?(?![a-zA-Z])": ""}
"""What GitHub's renderer reads and docutils does not; a size of a bar is left to the browser."""


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the renderer; `html_math_renderer = "mathml"` chooses it."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}


def _inline(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(_drawn(translator, node, as_block=False))
    raise nodes.SkipNode


def _block(translator: HTML5Translator, node: nodes.math_block) -> None:
    tag = _TAG.search(node.astext())
    label = f'<span class="equation-number">({translator.encode(tag[1])})</span>' if tag else ""
    equation = _drawn(translator, node, as_block=True)
    translator.body.append(f'<div class="equation">{equation}{label}</div>\n')
    raise nodes.SkipNode


def _drawn(translator: HTML5Translator, node: nodes.Element, *, as_block: bool) -> str:
    text = _TAG.sub("", node.astext()).strip()
    for pattern, spelling in _SPELLINGS.items():
        text = re.sub(pattern, spelling, text)
    try:
        return str(tex2mathml(text, as_block=as_block))
    except MathError as error:
        logging.getLogger(__name__).warning("formula not understood: %s: %s", error, text, location=node)
        return f"<code>{translator.encode(text)}</code>"
