"""What a campaign's report says of its sensitivity studies: each in short, with a link to its own page."""

from dataclasses import dataclass

import pandas as pd

from divideropt.analysis.house_of_quality import house_of_quality
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_problem, dividers
from divideropt.errors import DivideroptError
from divideropt.report.display import axis_of, labels_of
from divideropt.report.house_words import HouseRow, house_rows, house_sentence
from divideropt.report.sensitivity_data import method_of, quantity_words, read_indices
from divideropt.store import Store

METHODS = {"oat": "one parameter at a time", "morris": "Morris’s elementary effects", "sobol": "Sobol indices"}
"""The samplings in words."""


@dataclass(frozen=True)
class SobolSummary:
    """The numbers of a Sobol study in short.

    Attributes:
        indices: Its table of indices.
        objectives: Names of the objectives that have indices, and words for them.
        variables: Names of the variables, and labels.
        headings: Words and symbols of the variables.
        house: The House of Quality.
        sentence: What follows from it.
        blocks: How many blocks the indices are made from.
    """

    indices: pd.DataFrame
    objectives: tuple[tuple[str, str], ...]
    variables: tuple[tuple[str, str], ...]
    headings: tuple[tuple[str, str], ...]
    house: tuple[HouseRow, ...]
    sentence: str
    blocks: int


@dataclass(frozen=True)
class StudySummary:
    """A study in short.

    Attributes:
        name: Of its folder.
        words: Its method in words; why it cannot be read where it cannot.
        link: Its page from the campaign's report, None where it has none yet.
        sobol: The numbers of a Sobol study that has been analysed.
    """

    name: str
    words: str
    link: str | None
    sobol: SobolSummary | None


def study_summary(store: Store) -> tuple[StudySummary, ...]:
    """Sum up the studies in a campaign's store, by name; from their tables of indices, nothing is computed again."""
    return tuple(_summary(study) for study in store.studies())


def _summary(study: Store) -> StudySummary:
    name = study.folder.name
    link = f"{study.folder.parent.name}/{name}/{study.report_path.name}" if study.report_path.is_file() else None
    try:
        method = method_of(stored_campaign(study))
        sobol = _sobol(study) if method == "sobol" else None
    except DivideroptError as error:
        return StudySummary(name, f"cannot be read: {error}", link, None)
    return StudySummary(name, METHODS[method], link, sobol)


def _sobol(study: Store) -> SobolSummary | None:
    indices = read_indices(study)
    if indices is None or indices.empty:
        return None
    problem = build_problem(stored_campaign(study))
    axes = [axis_of(v.parameter, (v.lower, v.upper)) for v in problem.space.variables]
    known = set(indices["quantity"])
    names = dict.fromkeys(o.quantity.name for o in problem.objectives if o.quantity.name in known)
    house = house_of_quality(indices, problem, thesis=bool(dividers(problem.model)))
    return SobolSummary(
        indices,
        tuple((name, quantity_words(name, problem)) for name in names),
        tuple(zip([axis.name for axis in axes], labels_of(axes), strict=True)),
        tuple((axis.words, axis.symbol) for axis in axes),
        house_rows(house),
        house_sentence(house, {axis.name: axis.words for axis in axes}),
        int(indices["samples"].max()),
    )
