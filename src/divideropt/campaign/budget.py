"""The error budget of one design as a table: the work of `divideropt error-budget`."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from divideropt.campaign.config import Campaign
from divideropt.campaign.simulate import chosen_design, crashed
from divideropt.models.base import Verdict
from divideropt.models.divider.error_budget import REST, TOTAL, error_budget
from divideropt.models.divider.scenarios import BASE
from divideropt.problem import one_thread

_COLUMNS = ["cause", "share", "error_without"]


def budget_table(campaign: Campaign, settings: Sequence[str], scenario: str = BASE) -> tuple[pd.DataFrame, Verdict]:
    """Say what the steady-state error of one design is made of.

    Args:
        campaign: Whose model, scenario and parameters.
        settings: `NAME=VALUE` with a unit, for parameters that differ.
        scenario: Under which of the campaign's scenarios.

    Returns:
        A row a cause, with `cause`, `share` and `error_without` [%, signed as (3.11)]: the total, each cause, what is
        left with all off, what the causes do to each other, and Kwan's estimate of the flow force's share; and how
        the simulation with everything on ended.

    Raises:
        UsageError: As `divideropt.campaign.simulate.chosen_design`.
    """
    model, parameters = chosen_design(campaign, settings, scenario)
    try:
        with one_thread(), np.errstate(all="ignore"):  # a failed design says so by its outcome
            budget = error_budget(model, parameters)
    except (ArithmeticError, ValueError) as error:  # dimensions that no valve has
        return pd.DataFrame(columns=_COLUMNS), crashed(error)
    rows = [(TOTAL, budget.total, np.nan)]
    rows += [(cause, share, budget.without[cause]) for cause, share in budget.shares.items()]
    rows += [
        (REST, budget.rest, np.nan),
        ("interaction", budget.interaction, np.nan),
        ("kwan_estimate_of_flow_force", budget.kwan, np.nan),
    ]
    return pd.DataFrame(rows, columns=_COLUMNS), budget.verdict
