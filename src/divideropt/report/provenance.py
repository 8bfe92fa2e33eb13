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


SOFTWARE = (
    "The divideropt developers: divideropt: multiobjective optimisation of simulated hydraulic components. "
    "Version {version}."
)
THESIS = (
    "Travis Kent Wiens: An Adjustable-Ratio Flow Dividing Hydraulic Valve. Thesis, Master of Science. University of "
    "Saskatchewan, Department of Mechanical Engineering, Saskatoon, 2004."
)
"""What CITATION.cff asks to cite: the software, and of its own model the source."""


@dataclass(frozen=True)
class Provenance:
    """Where a report comes from.

    Attributes:
        here: Versions by name of what made the report, and its platform.
        writers: What each wrote with that wrote to the store, the latest last; empty where nobody noted it.
        commands: Lines for a shell that repeat the campaign, beside what each does.
        plugin: The user's own model, by its name in the campaign; "" where it is the platform's.
        works: What to cite.
    """

    here: Mapping[str, str]
    writers: tuple[Mapping[str, str], ...]
    commands: tuple[tuple[str, str], ...]
    plugin: str
    works: tuple[str, ...] = ()


def read_provenance(store: Store, campaign: Campaign, *, verifiable: bool) -> Provenance:
    """Say what computed a store, how to do it again, and what to cite; a model that has a reference is verifiable."""
    here = {"python": platform.python_version()} | {name: _version(name) for name in LIBRARIES}
    here["platform"] = f"{platform.system()} {platform.machine()}"
    writers = store.writers()
    plugin = campaign.model.kind if isinstance(campaign.model, PluginConfig) else ""
    commands = _commands(campaign, writers[-1] if writers else {})
    used = (writers[-1] if writers else here).get("divideropt", here["divideropt"])
    works = [SOFTWARE.format(version=used)] + ([] if plugin else [THESIS])
    return Provenance(here, writers, commands if verifiable else commands[:-1], plugin, tuple(works))


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
