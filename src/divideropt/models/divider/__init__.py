"""The adjustable-ratio flow divider of the thesis.

`Divider` is imported when it is first asked for: its kernels need a compiler, which takes as long to import as all
that reads a campaign.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from divideropt.models.divider.formulations import FORMULATIONS
from divideropt.models.divider.parameters import PARAMETER_SETS, PARAMETERS, parameter_set
from divideropt.models.divider.quantities import QUANTITIES
from divideropt.models.divider.scenario import Event, Scenario, load_step
from divideropt.models.divider.tolerances import solver_settings

if TYPE_CHECKING:
    from divideropt.models.divider.model import Divider

__all__ = [
    "FORMULATIONS",
    "PARAMETERS",
    "PARAMETER_SETS",
    "QUANTITIES",
    "Divider",
    "Event",
    "Scenario",
    "load_step",
    "parameter_set",
    "solver_settings",
]


def __getattr__(name: str) -> Any:
    """Import the model (PEP 562)."""
    if name != "Divider":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found = globals()[name] = import_module("divideropt.models.divider.model").Divider
    return found


def __dir__() -> list[str]:
    """List the public names, imported or not."""
    return sorted({*globals(), *__all__})
