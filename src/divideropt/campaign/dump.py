"""A `Campaign` to YAML text that reads back as an equal campaign, to the bit; and the schema of campaigns."""

import io
import re
from collections.abc import Mapping
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.representer import SafeRepresenter

from divideropt.campaign import schemas
from divideropt.campaign.config import Campaign, ConstraintConfig, ObjectiveConfig
from divideropt.campaign.fields import measure_of
from divideropt.campaign.uncertainty import with_failures
from divideropt.models import Parameter, Quantity


def dump_campaign(campaign: Campaign) -> str:
    """Write a campaign as resolved: every default filled in, every measure in the platform's units.

    Args:
        campaign: The campaign.

    Returns:
        YAML from which `parse_campaign` makes an equal campaign.
    """
    tables = with_failures(campaign.model.tables(), campaign.uncertainty is not None)
    parameters, quantities = tables.parameters or {}, tables.quantities or {}
    data = campaign.model_dump(mode="json", exclude_none=True, exclude={"model", *_BY_NAME})
    data["model"] = campaign.model.model_dump(mode="json", exclude_none=True)
    data["model"]["set"] = _measures(campaign.model.set, parameters)
    for scenario in data["model"].get("scenarios", {}).values():
        scenario["set"] = _measures(scenario["set"], parameters)
    data["variables"] = _ranges(campaign.variables, parameters)
    data["sensitivity"]["parameters"] = _ranges(campaign.sensitivity.parameters, parameters)
    data["objectives"] = _sections(campaign.objectives, quantities)
    data["constraints"] = _sections(campaign.constraints, quantities)
    data["reference_point"] = _measures(campaign.reference_point, quantities)
    data["strategies"] = {plan.name: plan.as_written() for plan in campaign.strategies}
    if campaign.uncertainty is not None:
        data["uncertainty"] = campaign.uncertainty.as_written(parameters)
    return _yaml({name: data[name] for name in Campaign.model_fields if name in data})


def dump_settings(values: Mapping[str, float], parameters: Mapping[str, Parameter]) -> str:
    """Write parameters by name as the section `set` of a campaign's model, from which the same bits are read."""
    return _yaml({"set": _measures(values, parameters)}, in_lines=True)


def campaign_schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of campaigns for the divider."""
    schema = schemas.with_shared_measures(Campaign.model_json_schema(), "UncertaintyConfig")
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        **schemas.uncertainty_rules(),
        "title": "divideropt campaign",
        "description": "A campaign for the flow divider, `model.kind: divider`.",
    }


_BY_NAME = ("variables", "objectives", "constraints", "reference_point", "uncertainty", "strategies")
"""Sections whose units hang on their keys, which pydantic cannot know."""


def _measures(values: Mapping[str, float], table: Mapping[str, Any]) -> dict[str, str | float]:
    return {name: measure_of(table[name]).write(value) for name, value in values.items()}


def _ranges(ranges: Mapping[str, tuple[float, float]], table: Mapping[str, Any]) -> dict[str, list[str | float]]:
    return {name: [measure_of(table[name]).write(end) for end in ends] for name, ends in ranges.items()}


def _sections(
    sections: Mapping[str, ObjectiveConfig] | Mapping[str, ConstraintConfig], table: Mapping[str, Quantity]
) -> dict[str, dict[str, Any]]:
    """Write objectives or constraints."""
    return {
        name: {
            field: _written(field, value, table[name])
            for field, value in section
            if value is not None and value != ()
        }
        for name, section in sections.items()
    }


def _written(field: str, value: Any, quantity: Quantity) -> Any:
    """Write a field of an objective or constraint; all but three are in the quantity's unit."""
    return {"weight": value, "worst_of": value, "statistic": value}.get(field) or measure_of(quantity).write(value)


def _yaml(data: dict[str, Any], *, in_lines: bool = False) -> str:
    yaml = YAML(typ="safe", pure=True)
    yaml.Representer = _CarefulRepresenter
    yaml.default_flow_style = False if in_lines else None  # the innermost collections on one line
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]  # ruamel annotates it as None
    yaml.allow_unicode = True
    yaml.width = 110
    text = io.StringIO()
    yaml.dump(data, text)
    return text.getvalue()


class _CarefulRepresenter(SafeRepresenter):
    """Quotes every string that is not plainly plain: ruamel leaves `:1` bare in braces, and cannot read that."""

    def represent_str(self, data: str) -> Any:
        style = None if _PLAIN.fullmatch(data) else '"'
        return self.represent_scalar("tag:yaml.org,2002:str", data, style=style)


_PLAIN = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+^/% -]*(?<! )", re.ASCII)

_CarefulRepresenter.add_representer(str, _CarefulRepresenter.represent_str)
