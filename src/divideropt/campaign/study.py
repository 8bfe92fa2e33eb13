"""A sensitivity study of a campaign: the work of `divideropt sensitivity`.

A study is a campaign itself, whose variables are what is studied and whose only strategy lays designs out; so its
store, in a folder of the campaign's, is logged, resumed, extended and shared among processes like any other.
"""

import dataclasses
import re
from collections.abc import Mapping, Sequence
from typing import Any, TextIO, cast

import numpy as np
from pydantic import ValidationError

from divideropt.campaign.config import Campaign, OptimalityConfig
from divideropt.campaign.divider import DividerConfig
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.extend import PROBLEM, differences
from divideropt.campaign.fields import measure_of
from divideropt.campaign.load import parse_campaign, stored_campaign
from divideropt.campaign.plans import StrategyPlan
from divideropt.campaign.ranges import read_range
from divideropt.campaign.runner import Runner
from divideropt.campaign.sections import relay, unknown
from divideropt.campaign.sensitivity import SensitivityConfig
from divideropt.errors import IncompleteRunsError, StoreError, UsageError
from divideropt.models import Parameter
from divideropt.models.divider.study import THESIS_RANGES
from divideropt.models.uncertain import FAILED_SHARE
from divideropt.store import Store

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}", re.ASCII)


@dataclasses.dataclass(frozen=True)
class Asked:
    """What a study is to be, where that is not what the campaign says.

    Attributes:
        method: oat, morris or sobol.
        parameters: What is studied, `NAME` or `NAME=LOWER..UPPER`; what the campaign says where empty.
        count: Points, trajectories or samples; None for the campaign's.
        alone: Whether a Sobol study goes without indices of pairs, whatever the campaign says.
    """

    method: str
    parameters: tuple[str, ...] = ()
    count: int | None = None
    alone: bool = False


def study_store(campaign_store: Store, name: str) -> Store:
    """Return the store of a study, there or not.

    Raises:
        UsageError: The name cannot be a folder's, or the campaign's folder is a file.
        StoreError: A file is where a folder should be.
    """
    if not _NAME.fullmatch(name):
        raise UsageError(
            f"--study {name!r} cannot name a folder; use 1 to 64 of A-Z, a-z, 0-9, - and _, a letter or digit first"
        )
    if campaign_store.folder.exists() and not campaign_store.folder.is_dir():
        raise UsageError(f"{campaign_store.folder}: a file, not a folder; name another --store")
    return campaign_store.study(name)


def check_home(campaign_store: Store, campaign: Campaign) -> None:
    """Check that a study is not put into the store of another campaign, nor into a damaged one.

    Raises:
        StoreError: There is a store, and it is.
    """
    if not campaign_store.exists:
        return
    found = list(differences(stored_campaign(campaign_store), campaign, ("name", *PROBLEM)))
    if found:
        raise StoreError(
            f"{campaign_store.folder}: this store belongs to another campaign:\n  "
            + "\n  ".join(found)
            + "\nName another folder for the study (--store)."
        )


def study_of(campaign: Campaign, asked: Asked) -> Campaign:
    """Make the campaign that is a study of another.

    Args:
        campaign: What is studied.
        asked: How.

    Returns:
        The same model, objectives and constraints, of a campaign with uncertainty the nominal ones; its variables
        are the parameters studied, its only strategy the sampling.

    Raises:
        UsageError: A parameter or a count is wrong.
    """
    config = campaign.sensitivity
    options = _options(config, asked)
    ranges = _ranges(campaign, asked)
    if asked.method == "oat":
        _check_wide(ranges, options.points)
    study = _certain(campaign).model_copy(
        update={
            "nominal": False,
            "variables": ranges,
            "strategies": (StrategyPlan(asked.method, options, (config.seed,)),),
            "sensitivity": SensitivityConfig(),
            "verification": campaign.verification.model_copy(update={"sample": 0}),
            "optimality": OptimalityConfig(points=0),
        }
    )
    return parse_campaign(dump_campaign(study), f"the study {asked.method} of {campaign.name}")


def run_study(
    study: Campaign, store: Store, workers: int | None, words: TextIO, again: str, *, fresh: bool = False
) -> None:
    """Run what is not yet in a study's store.

    Args:
        study: From `study_of`.
        store: Its own, from `study_store`.
        workers: Processes at a time; the campaign's where None.
        words: Where progress is shown.
        again: The command that goes on if this one is stopped.
        fresh: Whether to move an existing store aside first.

    Raises:
        IncompleteRunsError: The run was given up.
        DivideroptError: As `Runner.sample` does.
    """
    runner = Runner(study, store.folder, workers or study.parallel.workers, words, again)
    failures = runner.sample(fresh=fresh)
    if failures:
        reasons = "\n  ".join(f"{name}: {reason}" for name, reason in failures.items())
        raise IncompleteRunsError(f"{store.folder}: the study is incomplete:\n  {reasons}\nTo try again:\n  {again}")


def _certain(campaign: Campaign) -> Campaign:
    """Leave uncertainty out: what is asked of statistics is asked of the design as it is, of its samples nothing."""
    asked = ("objectives", "constraints", "reference_point")
    sections = {
        section: {name: entry for name, entry in getattr(campaign, section).items() if name != FAILED_SHARE.name}
        for section in asked
    }
    for section in asked[:2]:
        sections[section] = {
            name: entry.model_copy(update={"statistic": None}) for name, entry in sections[section].items()
        }
    return campaign.model_copy(update={**sections, "uncertainty": None})


def _options(config: SensitivityConfig, asked: Asked) -> Any:
    """The sampling with its options, its count replaced where another is asked for."""
    options: Any = getattr(config, asked.method)
    if asked.alone and asked.method != "sobol":
        raise UsageError(f"--no-second-order is of method sobol, not {asked.method}; leave it away")
    if asked.alone:
        options = dataclasses.replace(options, second_order=False)
    if asked.count is None:
        return options
    name = {"oat": "points", "morris": "trajectories", "sobol": "samples"}[asked.method]
    try:
        return type(options)(**{**dataclasses.asdict(options), name: asked.count})
    except ValidationError as error:
        (found, *_) = relay(error)
        raise UsageError(f"--samples {asked.count}: {cast(Any, found['type']).message()}") from None


def _check_wide(ranges: Mapping[str, tuple[float, float]], points: int) -> None:
    """Refuse a range in which a sweep would come to the same value twice, for want of numbers between its ends."""
    for name, (lower, upper) in ranges.items():
        if (np.diff(np.linspace(lower, upper, points)) <= 0.0).any():
            raise UsageError(
                f"{name}: between {lower!r} and {upper!r} there are no {points} different numbers for a sweep; widen "
                f"its range, by --parameter '{name}=LOWER..UPPER' or in the campaign"
            )


def _ranges(campaign: Campaign, asked: Asked) -> Mapping[str, tuple[float, float]]:
    """What is studied, between which ends."""
    usual = dict(campaign.sensitivity.parameters) or _usual(campaign, asked.method)
    if not asked.parameters:
        return usual
    table = campaign.model.tables().parameters or {}
    known = {**campaign.variables, **_usual(campaign, "oat"), **usual}
    found: dict[str, tuple[float, float]] = {}
    for text in asked.parameters:
        name, ends = _asked_range(text, table, known, _set_by(campaign))
        if name in found:
            raise UsageError(f"--parameter {text}: {name} is named a second time; leave one of the two away")
        found[name] = ends
    return found


def _usual(campaign: Campaign, method: str) -> dict[str, tuple[float, float]]:
    model = campaign.model
    if method != "oat" or not isinstance(model, DividerConfig):
        return dict(campaign.variables)
    theirs = _set_by(campaign)
    return {name: ends for name, ends in THESIS_RANGES.items() if name not in theirs}


def _set_by(campaign: Campaign) -> dict[str, str]:
    """The parameters that scenarios set, each with the first that does."""
    model = campaign.model
    changes = model.changes() if isinstance(model, DividerConfig) else {}
    return {name: scenario for scenario in reversed(changes) for name in changes[scenario]}


def _asked_range(
    text: str, table: Mapping[str, Parameter], known: Mapping[str, tuple[float, float]], set_by: Mapping[str, str]
) -> tuple[str, tuple[float, float]]:
    """Read `NAME`, whose range is known, or `NAME=LOWER..UPPER`."""
    name, equals, written = text.partition("=")
    name = name.strip()
    if name not in table:
        raise UsageError(f"--parameter {text}: {unknown('parameter', name, table)}")
    if name in set_by:
        raise UsageError(
            f"--parameter {name}: scenario {set_by[name]} sets it, where a study could not vary it; study a campaign "
            "whose scenarios do not"
        )
    if not equals:
        if name not in known:
            example = measure_of(table[name]).write(table[name].default)
            raise UsageError(
                f"--parameter {name}: neither the campaign nor the thesis has a range for it; write "
                f"--parameter '{name}=LOWER..UPPER', around {example}, say"
            )
        return name, known[name]
    ends: Sequence[str] = [end.strip() for end in written.split("..")]
    if len(ends) != 2:
        raise UsageError(f"--parameter {text}: {written!r} is not a range; write NAME=LOWER..UPPER")
    try:
        return name, read_range(table[name], list(ends))
    except ValueError as error:
        reason = cast(Any, error).errors()[0]["msg"] if hasattr(error, "errors") else str(error)
        raise UsageError(f"--parameter {text}: {reason}") from None
