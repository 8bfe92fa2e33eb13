"""Tables with units: what the columns of a `DataFrame` are, in its `attrs`; and words as a notebook shows them."""

from collections.abc import Mapping
from html import escape

import pandas as pd
import pyarrow as pa

from divideropt.models import Parameter, Quantity

_KEYS = {"units": "unit", "symbols": "symbol", "descriptions": "description"}


def stored_frame(table: pa.Table) -> pd.DataFrame:
    """Make a DataFrame of a table of the store, with what the file says of each column."""
    frame: pd.DataFrame = table.to_pandas()
    for name, key in _KEYS.items():
        found = {field.name: (field.metadata or {}).get(key.encode(), b"").decode() for field in table.schema}
        frame.attrs[name] = found
    return frame


def modelled_frame(frame: pd.DataFrame, *known: Mapping[str, Parameter] | Mapping[str, Quantity]) -> pd.DataFrame:
    """Say of each column what a model does; "" of those that are none of its parameters or quantities."""
    entries: dict[str, Parameter | Quantity] = {name: entry for table in known for name, entry in table.items()}
    for name, key in _KEYS.items():
        frame.attrs[name] = {str(c): getattr(entries[c], key) if c in entries else "" for c in frame.columns}
    return frame


def preformatted(text: str) -> str:
    """Make HTML of lines that are not to be broken, such as a table in text."""
    return f"<pre>{escape(text)}</pre>"
