"""Ranges of parameters, as a campaign has them."""

from collections.abc import Mapping

from divideropt.campaign.fields import measure_of
from divideropt.campaign.sections import collect, show
from divideropt.models import Parameter


def read_range(parameter: Parameter, raw: object) -> tuple[float, float]:
    """Read a parameter's `[lower, upper]`; raises ValueError with a sentence."""
    if isinstance(raw, Mapping):
        reserved = (
            "`choices` and `step` are reserved" if {"choices", "step"} & raw.keys() else "a mapping is no range"
        )
        raise ValueError(f"{reserved}; write a range, [lower, upper]")
    if not isinstance(raw, list | tuple) or len(raw) != 2:
        raise ValueError(f"{show(raw)} is not a range; write two values, [lower, upper]")
    ends = collect(dict(enumerate(raw)), (0, 1), "bound", lambda _, end: measure_of(parameter).read(end))
    if ends[0] >= ends[1]:
        raise ValueError(
            f"the lower bound {show(raw[0])} is not below the upper, {show(raw[1])}; exchange or widen them"
        )
    return ends[0], ends[1]
