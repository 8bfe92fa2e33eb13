"""The figure that stands for a sensitivity study: what its parameters do to a quantity, or to each objective."""

from collections.abc import Iterable

import plotly.graph_objects as go

from divideropt.campaign.load import stored_campaign
from divideropt.campaign.sections import nearest
from divideropt.errors import UsageError
from divideropt.report.sensitivity_data import StudyData, method_of, quantity_words, read_study
from divideropt.report.sensitivity_figures import effects_figure, index_bars, variable_labels
from divideropt.report.sweep_figures import panels_figure
from divideropt.report.sweeps_data import SweepsData, read_sweeps
from divideropt.store import Store


def study_figure(store: Store, quantity: str | None = None) -> go.Figure:
    """Draw a study.

    Args:
        store: The study's own store.
        quantity: Of what; of the objectives where not given, of a study one parameter at a time of the first.

    Returns:
        One parameter at a time: the quantity over each, a panel a parameter. Morris: σ against μ*, and Sobol:
        first-order and total indices with 95 % intervals, a panel a quantity.

    Raises:
        UsageError: The store is of no study, or the study has no numbers of this quantity.
        StoreError: It is damaged or of a later version.
    """
    if method_of(stored_campaign(store)) == "oat":
        return _sweeps(read_sweeps(store), quantity)
    return _indices(read_study(store), quantity)


def _sweeps(data: SweepsData, quantity: str | None) -> go.Figure:
    known = data.quantities if data.parts else {}
    chosen = quantity or next((name for name in data.objectives if name in known), next(iter(known), ""))
    _check(chosen, known)
    return panels_figure(data, chosen)


def _indices(data: StudyData, quantity: str | None) -> go.Figure:
    known = (*data.objectives, *data.others)
    chosen = data.objectives if quantity is None else (quantity,)
    for name in chosen or ("",):
        _check(name, known)
    if data.method == "morris":
        return effects_figure(data, chosen)
    return index_bars(
        data.indices, [(name, quantity_words(name, data.problem)) for name in chosen], variable_labels(data)
    )


def _check(quantity: str, known: Iterable[str]) -> None:
    names = list(known)
    if quantity in names:
        return
    if not names:
        raise UsageError("plot: the study has no numbers yet; run it to its end first")
    meant = nearest(quantity, names)
    remedy = f"did you mean {meant}?" if meant else f"there are {', '.join(names)}"
    raise UsageError(f"plot: the study has no numbers of {quantity!r}; {remedy}")
