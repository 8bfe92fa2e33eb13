"""One self-contained HTML document: template, styles, scripts and data in one text, every string escaped."""

import base64
import hashlib
import json
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.utils import PlotlyJSONEncoder

from divideropt.report.bundle import plotly_for
from divideropt.report.palette import COLOURS
from divideropt.store.files import disk_errors, publish

CONFIG: Mapping[str, Any] = {
    "displaylogo": False,  # links to plotly's makers
    "showSendToCloud": False,  # the "share" button, which would send the data to a server
    "plotlyServerURL": "",
    "modeBarButtonsToRemove": ["sendChartToCloud", "select2d", "lasso2d", "autoScale2d"],
    "responsive": False,  # the page's script sees to it, on paper too
}
"""What every figure is drawn with."""

SCRIPTS = (
    "page.js",
    "designs.js",
    "selection.js",
    "figures.js",
    "points.js",
    "parallel.js",
    "brushes.js",
    "closely.js",
    "sketch.js",
    "sheet.js",
    "tables.js",
    "bar.js",
    "fragment.js",
    "scrollers.js",
    "report.js",
)
"""The page's script in its parts, one idea each; they share one scope, in this order."""

_ESCAPES = str.maketrans({"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"})


def render(template: str, payload: Mapping[str, Any], **context: Any) -> str:
    """Fill a template.

    Args:
        template: Its file's name.
        payload: What the page's script draws.
        context: What the template shows; plain strings are escaped.

    Returns:
        The document.
    """
    script = _script()
    plotly = plotly_for(trace.get("type", "scatter") for figure in payload["figures"] for trace in figure["data"])
    return (
        _environment()
        .get_template(template)
        .render(
            **context,
            style=Markup(_asset("report.css") + _asset("sketch.css")),
            plotly=Markup(plotly),
            script=Markup(script),
            scripts=" ".join(_hash(text) for text in (plotly, script)),
            payload=_embedded({"config": CONFIG, "colours": COLOURS, **payload}),
        )
    )


def drawn(name: str, figure: Any, **more: Any) -> dict[str, Any]:
    """Word a figure for the page's script; `name` is the id of its element."""
    traces = [trace.to_plotly_json() for trace in figure.data]
    return {"id": name, "data": traces, "layout": figure.layout.to_plotly_json(), **more}


def save(out: Path, text: str) -> Path:
    """Write a document so that it is there whole or not at all, and return its path.

    Raises:
        DiskError: The disk refused.
    """
    with disk_errors(out.parent):
        out.parent.mkdir(parents=True, exist_ok=True)
    publish(out, lambda path: _write(path, text))
    return out


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


def _embedded(payload: Mapping[str, Any]) -> Markup:
    """Write JSON that no HTML parser sees a tag or a comment in."""
    text = json.dumps(payload, cls=PlotlyJSONEncoder, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return Markup(text.translate(_ESCAPES))


@cache
def _script() -> str:
    """Join the parts in a function, so that nothing of them is global."""
    parts = "\n".join(_asset(name) for name in SCRIPTS)
    return f'"use strict";\n(function () {{\n{parts}\n}})();'


def _hash(script: str) -> str:
    """Name a script to the content security policy: no other inline script runs, whatever gets into the page."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"


@cache
def _asset(name: str) -> str:
    return files("divideropt.report").joinpath("templates", name).read_text("utf-8")


@cache
def _environment() -> Environment:
    return Environment(
        loader=PackageLoader("divideropt.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
