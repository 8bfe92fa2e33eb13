"""A sensitivity study's store to what its page says: frozen, in the platform's units."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
import pyarrow as pa

from divideropt.analysis.failures import Failures
from divideropt.analysis.house_of_quality import House, house_of_quality
from divideropt.analysis.morris import morris_study
from divideropt.analysis.sobol import COLUMNS, sobol_study
from divideropt.analysis.treatments import OUTCOME, Treatment, Undefined
from divideropt.campaign.config import Campaign
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_problem, dividers, plan_runs
from divideropt.errors import UsageError
from divideropt.problem import Evaluations, Problem, one_thread
from divideropt.report.display import Axis, axis_of
from divideropt.report.setting import setting_of
from divideropt.store import Store, TableSchema
from divideropt.store.files import publish

INDICES = "indices.parquet"
"""The table of indices, in the study's store."""

_FIRST = (str(Treatment.ALL), str(Treatment.WORKING))
_UNITS = {"morris": ("trajectory", "trajectories"), "sobol": ("block", "blocks")}


@dataclass(frozen=True)
class StudyData:
    """All that the page of a Morris or Sobol study says.

    Attributes:
        name: The campaign's name.
        method: morris or sobol.
        campaign: The study as resolved, YAML.
        setting: What was simulated, as pairs of a heading and a sentence.
        problem: What was studied.
        variables: How each variable is shown, its lower and its upper bound.
        indices: Every number, see `SobolStudy.indices` and `MorrisStudy.effects`.
        undefined: Quantities without numbers, and why.
        failures: Where designs failed.
        units: How many whole blocks or trajectories there are.
        failed_blocks: Blocks with a failed design; None of a Morris study.
        notes: Sentences on what is not there.
        house: The House of Quality; None of a Morris study.
        seed: The sample's.
    """

    name: str
    method: str
    campaign: str
    setting: tuple[tuple[str, str], ...]
    problem: Problem
    variables: tuple[tuple[Axis, float, float], ...]
    indices: pd.DataFrame
    undefined: tuple[Undefined, ...]
    failures: Failures
    units: int
    failed_blocks: int | None
    notes: tuple[str, ...]
    house: House | None
    seed: int

    @property
    def unit(self) -> str:
        """What the sample is counted in."""
        return _UNITS[self.method][self.units != 1]

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives that have numbers under the treatment to look at first."""
        asked, shown = dict.fromkeys(o.quantity.name for o in self.problem.objectives), self._shown()
        return tuple(name for name in asked if name in shown)

    @property
    def others(self) -> tuple[str, ...]:
        """Names of the other quantities that have numbers so; first whether the outcome is ok."""
        return tuple(name for name in self._shown() if name not in self.objectives)

    def first(self, quantity: str, kind: str) -> pd.DataFrame:
        """The numbers of all the sample under the treatment to look at first, by variable."""
        return first_of(self.indices, quantity, kind)

    def _shown(self) -> dict[str, None]:
        first = self.indices["treatment"].isin(_FIRST) & (self.indices["samples"] == self.indices["samples"].max())
        return dict.fromkeys(self.indices["quantity"][first])


def first_of(indices: pd.DataFrame, quantity: str, kind: str) -> pd.DataFrame:
    """The numbers of a table of the whole sample under the treatment to look at first, indexed by variable."""
    chosen = (indices["quantity"] == quantity) & (indices["kind"] == kind)
    chosen &= indices["samples"] == indices["samples"].max()
    chosen &= indices["treatment"].isin(_FIRST)
    found: pd.DataFrame = indices[chosen].set_index("variable")
    return found


def is_study(campaign: Campaign) -> bool:
    """Whether a store's campaign is a sensitivity study: its only strategy is a sampling."""
    return len(campaign.strategies) == 1 and campaign.strategies[0].name in ("oat", *_UNITS)


def method_of(campaign: Campaign) -> str:
    """The sampling of a study.

    Raises:
        UsageError: The campaign is no study.
    """
    names = [plan.name for plan in campaign.strategies]
    if not is_study(campaign):
        raise UsageError(
            f"{campaign.name}: strategies {', '.join(names)}: no sensitivity study; name the store of one"
        )
    return names[0]


def read_study(store: Store) -> StudyData:
    """Analyse what a Morris or Sobol study has logged, finished or not.

    Raises:
        UsageError: There is no store, it is no such study, or less than a block or trajectory is logged.
        FileMistakes: The campaign in it cannot be read.
        StoreError: The log is damaged or of a later version.
    """
    campaign = stored_campaign(store)
    method, problem, run = method_of(campaign), build_problem(campaign), plan_runs(campaign)[0]
    schema = TableSchema.of(problem)
    parts = [schema.evaluations(part) for part in store.log(run.name, schema).read()]
    logged = sum(len(part) for part in parts)
    notes = [] if logged >= run.budget else [f"Not finished: {logged} of {run.budget} designs are simulated."]
    least = run.budget // _count(run.options)
    if logged < least:
        raise UsageError(
            f"{store.folder}: {logged} designs are logged, and one {_UNITS[method][0]} has {least}: nothing to "
            "analyse yet; let the study go on"
        )
    together = Evaluations.together(parts)
    house, failed_blocks = None, None
    if method == "sobol":
        with one_thread():  # with another number of threads the last bits of the intervals would be others
            sobol = sobol_study(together, problem)
        table, undefined, failures = sobol.indices, sobol.undefined, sobol.failures
        units, failed_blocks, left_over = sobol.blocks, sobol.failed_blocks, sobol.left_over
        house = house_of_quality(table, problem, thesis=bool(dividers(problem.model)))
    else:
        morris = morris_study(together, problem)
        table, undefined, failures = morris.effects, morris.undefined, morris.failures
        units, left_over = morris.trajectories, morris.left_over
    if left_over:
        notes.append(f"The last {left_over} designs make no whole {_UNITS[method][0]} and are left out.")
    return StudyData(
        campaign.name,
        method,
        store.read_campaign(),
        setting_of(campaign),
        problem,
        tuple((axis_of(v.parameter, (v.lower, v.upper)), v.lower, v.upper) for v in problem.space.variables),
        table,
        undefined,
        failures,
        units,
        failed_blocks,
        tuple(notes),
        house,
        run.seed,
    )


def quantity_words(name: str, problem: Problem) -> str:
    """Name a quantity for people; of a signed one the magnitude is analysed, which is said."""
    if name == OUTCOME:
        return "outcome ok"
    quantity = problem.model.quantities[name]
    words = axis_of(quantity, ()).words
    return f"magnitude of {words}" if quantity.signed else words


def write_indices(data: StudyData, store: Store) -> None:
    """Write the table of a study's numbers into its store.

    Raises:
        DiskError: The disk refused.
    """
    table = data.indices
    publish(store.folder / INDICES, lambda path: table.to_parquet(path, index=False))


def read_indices(store: Store) -> pd.DataFrame | None:
    """Read that table; None where it is not there, or not ours."""
    path = store.folder / INDICES
    try:
        table = pd.read_parquet(path)
    except (OSError, ValueError, pa.ArrowException):
        return None
    return table if _is_of_indices(table) else None


def _is_of_indices(table: pd.DataFrame) -> bool:
    """Whether a table is one that a study has written: a file in a store may be anybody's."""
    if list(table.columns) != list(COLUMNS):
        return False
    numbers, words = table[["value", "low", "high", "samples", "used"]], ["quantity", "variable", "kind", "treatment"]
    if not all(pd.api.types.is_numeric_dtype(kind) for kind in numbers.dtypes):
        return False
    if not bool(np.isfinite(numbers[["value", "samples"]].to_numpy(np.float64)).all()):
        return False
    texts = all(isinstance(text, str) for column in words for text in table[column])
    keys = table[[*words, "with", "samples"]].astype(str)
    return texts and not bool(keys.duplicated().any())


def _count(options: object) -> int:
    """Blocks or trajectories that a sampling asks for."""
    counts: Sequence[int] = [getattr(options, name) for name in ("samples", "trajectories") if hasattr(options, name)]
    return counts[0]
