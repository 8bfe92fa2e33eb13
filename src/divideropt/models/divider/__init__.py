"""The adjustable-ratio flow divider of the thesis."""

from divideropt.models.divider.formulations import FORMULATIONS
from divideropt.models.divider.model import Divider
from divideropt.models.divider.parameters import PARAMETER_SETS, PARAMETERS, parameter_set
from divideropt.models.divider.quantities import QUANTITIES
from divideropt.models.divider.scenario import Event, Scenario, load_step
from divideropt.models.divider.tolerances import solver_settings

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
