"""What a caller may give: a campaign by its path, as text, or read already."""

import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from divideropt.campaign.compiling import say_when_compiling
from divideropt.campaign.config import Campaign
from divideropt.campaign.load import default_campaign, load_campaign, parse_campaign
from divideropt.models import Parameter
from divideropt.models.divider import PARAMETERS
from divideropt.units import format_measure

Given = Campaign | Path | str
"""A campaign: read already, a file, or its text, which has more than one line."""


Design = Mapping[str, float | str]
"""Parameters by name: a number in the parameter's unit (SI), or a text with a unit, such as "9 mm"."""


def campaign_given(given: Given | None) -> Campaign:
    """Read what was given; the campaign that ships with the package where nothing was.

    Raises:
        UsageError: The file cannot be read.
        FileMistakes: Everything wrong in the campaign, with line and column.
    """
    listen()
    if given is None:
        return default_campaign()
    if isinstance(given, Campaign):
        return given
    if isinstance(given, str) and "\n" in given:
        return parse_campaign(given)
    return load_campaign(given)


@cache
def listen() -> None:
    """Say on standard error when this process first compiles something, which looks like a hang."""
    say_when_compiling(sys.stderr)


def setting(name: str, value: float | str, known: Mapping[str, Parameter] = PARAMETERS) -> str:
    """Word a parameter as the command line has it; a number is in the parameter's unit."""
    if isinstance(value, str):
        return f"{name}={value}"
    unit = known[name].unit if name in known else ""
    return f"{name}={format_measure(float(value), unit)}"
