"""Designs simulated: one with its response, or a table of them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import plotly.graph_objects as go

from divideropt.api.frames import modelled_frame, preformatted
from divideropt.api.given import Design, Given, campaign_given, setting
from divideropt.campaign.budget import budget_table
from divideropt.campaign.designs import evaluate_designs, parse_designs, read_designs, result_columns
from divideropt.campaign.plan import build_model
from divideropt.campaign.simulate import COLUMNS, SimulatedResponse
from divideropt.campaign.simulate import simulate as simulate_one
from divideropt.errors import UsageError
from divideropt.models.divider import PARAMETERS
from divideropt.report.response_page import curves_of, response_figure, write_response

_FEW = 3
"""So many metrics stand for all: the first are those of the thesis's objectives."""


@dataclass(frozen=True, repr=False)
class Simulated:
    """One design's response."""

    response: SimulatedResponse
    """What `divideropt.campaign.simulate` returned."""

    def __repr__(self) -> str:
        """Say how it ended, its first metrics, and what else there is."""
        shown = [
            f"{name}: {value:.6g} {unit}".rstrip()
            for name, value, unit in self.quantities[["value", "unit"]].head(_FEW).itertuples()
        ]
        words = [f"outcome: {self.outcome} {self.text}".rstrip(), *shown]
        return "\n".join([*words, "…", ".quantities, .parameters and .table have all of it, .plot() draws it"])

    def _repr_html_(self) -> str:
        """Show every metric with its unit in a notebook."""
        words = preformatted(f"outcome: {self.outcome} {self.text}".rstrip())
        return f"{words}{self.quantities.to_html()}{preformatted('.plot() draws it, .table has every instant')}"

    @property
    def outcome(self) -> str:
        """How the simulation ended: ok, or why not, in a word."""
        return str(self.response.verdict.outcome)

    @property
    def text(self) -> str:
        """Why it did not end well, in a sentence; "" where it did."""
        return self.response.verdict.text

    @property
    def table(self) -> pd.DataFrame:
        """A row an instant: time, the nine states, the load pressures and flows; SI, see `attrs["units"]`."""
        table = self.response.table.copy()
        table.attrs["units"] = dict(COLUMNS)
        return table

    @property
    def parameters(self) -> pd.DataFrame:
        """A row a parameter of the design: value, unit, symbol, description."""
        known = self.response.model.parameters
        return _listed({name: (value, known[name]) for name, value in self.response.parameters.items()}, "parameter")

    @property
    def quantities(self) -> pd.DataFrame:
        """A row a metric: value (NaN where not defined), unit, symbol, description."""
        known = self.response.model.quantities
        return _listed({name: (value, known[name]) for name, value in self.response.quantities.items()}, "quantity")

    def plot(self) -> go.Figure:
        """Draw load flows, pressures and spool displacement over time."""
        return response_figure(curves_of(self.response))

    def write(self, out: Path | str) -> Path:
        """Write that picture as a page of its own (.html), which asks nothing of any server.

        Raises:
            DiskError: The disk refused.
        """
        return write_response(self.response, Path(out))


def simulate(
    design: Given | Design | pd.Series | None = None,
    *,
    campaign: Given | None = None,
    set: Design | None = None,
    scenario: str = "scenario",
) -> Simulated:
    """Simulate one response; `divideropt simulate`.

    Args:
        design: Parameters that differ from the campaign's, or a row of a front, of which the parameters count; or the
            campaign itself.
        campaign: Whose model, scenario and parameters; the one that ships with the package where not given.
        set: Parameters that differ from both.
        scenario: Under which of the campaign's scenarios.

    Returns:
        The response; a design that fails has an outcome that says so, and NaN where a metric is not defined.

    Raises:
        UsageError: A name is no parameter, a value out of its domain; the campaign is given twice, or its model has
            no response.
        FileMistakes: Everything wrong in the campaign, with line and column.
    """
    changes: dict[str, float | str] = {}
    if isinstance(design, pd.Series):
        changes = {str(name): value for name, value in design.items() if name in PARAMETERS}
    elif isinstance(design, Mapping):
        changes = dict(design)
    elif design is not None:
        if campaign is not None:
            raise UsageError(
                "simulate: a campaign is given twice, first and by name; give one, and the design by `set`"
            )
        campaign = design
    settings = [setting(name, value) for name, value in (changes | dict(set or {})).items()]
    return Simulated(simulate_one(campaign_given(campaign), settings, scenario))


def error_budget(
    campaign: Given | None = None, *, set: Design | None = None, scenario: str = "scenario"
) -> pd.DataFrame:
    """Say what the steady-state error of one design is made of, in percent; `divideropt error-budget`.

    Args:
        campaign: Whose model, scenario and parameters; the one that ships with the package where not given.
        set: Parameters that differ.
        scenario: Under which of the campaign's scenarios.

    Returns:
        The table of the command; `attrs["outcome"]` says how the simulation ended.

    Raises:
        UsageError: As `simulate`.
        FileMistakes: Everything wrong in the campaign, with line and column.
    """
    settings = [setting(name, value) for name, value in (set or {}).items()]
    table, verdict = budget_table(campaign_given(campaign), settings, scenario)
    table.attrs["outcome"] = str(verdict.outcome)
    return table


def evaluate(designs: pd.DataFrame | Path | str, campaign: Given | None = None) -> pd.DataFrame:
    """Evaluate every design of a table; `divideropt evaluate`.

    Args:
        designs: A DataFrame, a front say, or a CSV file: columns are parameters by name, SI; `design_id` is passed
            through, and columns of results are passed over.
        campaign: Whose model, scenario and parameters; the one that ships with the package where not given.

    Returns:
        A row a design, in their order: the columns given, every quantity, `outcome` and `outcome_text`.

    Raises:
        UsageError: The file cannot be read.
        FileMistakes: Every unknown column, empty cell and value out of its domain, with row and column; or what is
            wrong in the campaign.
    """
    asked = campaign_given(campaign)
    model = build_model(asked)
    parameters, results = tuple(model.parameters.values()), result_columns(model)
    if isinstance(designs, pd.DataFrame):
        read = parse_designs(designs.to_csv(index=False), "designs", parameters, results)
    else:
        read = read_designs(Path(designs), parameters, results)
    table = evaluate_designs(read, model, asked.model.base_parameters())
    return modelled_frame(table, model.parameters, model.quantities)


def _listed(entries: Mapping[str, tuple[float, object]], name: str) -> pd.DataFrame:
    columns = ("unit", "symbol", "description")
    rows = [[value, *(getattr(entry, key) for key in columns)] for value, entry in entries.values()]
    return pd.DataFrame(rows, columns=["value", *columns], index=pd.Index(list(entries), name=name))
