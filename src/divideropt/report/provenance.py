"""What computed a store and what made its report: versions, machines, and the lines that do it again."""

import platform
import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

from divideropt.campaign.config import Campaign
from divideropt.campaign.plugin import PluginConfig
from divideropt.store import Store

LIBRARIES = (
    "divideropt",
    "numpy",
    "scipy",
    "numba",
    "pymoo",
    "moocore",
    "pandas",
    "pyarrow",
    "SALib",
    "plotly",
    "jinja2",
)
"""Whose versions the report names: what computes, stores and draws."""


@dataclass(frozen=True)
class Provenance:
    """Where a report comes from.

    Attributes:
        here: Versions by name of what made the report, and its platform.
        writers: What each wrote with that wrote to the store, the latest last; empty where nobody noted it.
        commands: Lines for a shell that repeat the campaign, beside what each does.
        plugin: The user's own model, by its name in the campaign; "" where it is the platform's.
    """

    here: Mapping[str, str]
    writers: tuple[Mapping[str, str], ...]
    commands: tuple[tuple[str, str], ...]
    plugin: str


def read_provenance(store: Store, campaign: Campaign) -> Provenance:
    """Say what computed a store, and how to do it again."""
    here = {"python": platform.python_version()} | {name: _version(name) for name in LIBRARIES}
    here["platform"] = f"{platform.system()} {platform.machine()}"
    writers = store.writers()
    plugin = campaign.model.kind if isinstance(campaign.model, PluginConfig) else ""
    return Provenance(here, writers, _commands(campaign, writers[-1] if writers else {}), plugin)


def _commands(campaign: Campaign, writer: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    pins = [f"{name}=={writer[name]}" for name in LIBRARIES if name != "divideropt" and name in writer]
    again = shlex.quote(f"results/{campaign.name}-again")
    lines = []
    if pins:
        lines.append(("python -m pip install " + " ".join(map(shlex.quote, pins)), "the libraries as they were"))
    lines += [
        ("divideropt check campaign.yaml", "the file is whole"),
        (f"divideropt run campaign.yaml --store {again}", "every run anew, from its seed"),
        (f"divideropt verify {again}", "all of the front once more, by the model's reference"),
    ]
    return tuple(lines)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed as a package"
