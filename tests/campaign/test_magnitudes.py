"""Numbers as large and as small as they may be: everything is computed, no sum or square is lost on the way."""

import io

import numpy as np
import pandas as pd
import pytest

from divideropt.campaign.compare import compare_stores
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.campaign.status import read_status
from divideropt.campaign.study import Asked, run_study, study_of, study_store
from divideropt.errors import FileMistakes
from divideropt.report import write_report, write_study
from divideropt.store import Store

TEXT = """
name: vast
model: {{kind: "vast_model:Vast", options: {{size: '{size!r}', span: '{span!r}'}}}}
variables: {{x1: [{lower!r}, {span!r}], x2: [{lower!r}, {span!r}]}}
objectives:
  f1: {{goal: {goal!r}, weight: {weight!r}}}
  f2: {{goal: {goal!r}}}
reference_point: {{f1: {reference!r}, f2: {reference!r}}}
strategies:
  nsga2: {{population: 12, generations: 3, seeds: [1]}}
  complex: {{points: 6, evaluations: 30, seeds: [1]}}
parallel: {{workers: 1, backend: sequential}}
"""
USUAL = {"size": 1.0, "span": 1.0, "lower": 0.0, "goal": 0.5, "weight": 1.0, "reference": 5.0}
EXTREMES = {
    "wide box": {"span": 1e50, "lower": -1e50},
    "narrow box": {"span": 1e-50},
    "large objectives": {"size": 5e49, "goal": 1e50, "reference": 1e50},
    "large objectives, small goals": {"size": 5e49, "goal": 1e-50, "weight": 1e50, "reference": 1e-50},
    "small objectives": {"size": 1e-49, "goal": 1e-50, "reference": 1e-48},
    "all is large": {"size": 4e49, "span": 1e50, "lower": -1e50, "goal": -1e50, "weight": 1e50, "reference": 1e50},
}


@pytest.mark.parametrize("extreme", EXTREMES.values(), ids=EXTREMES)
def test_a_campaign_at_the_limits_is_run_reported_and_studied(tmp_path, extreme):
    """A warning of numpy's, an overflow say, is an error in these tests."""
    campaign = parse_campaign(TEXT.format(**USUAL | extreme))
    Runner(campaign, tmp_path, 1, io.StringIO()).run()
    store = Store(tmp_path)
    status = read_status(store)
    assert [np.isfinite((run.best, run.hypervolume)).all() for run in status.runs] == [True, True]
    assert status.runs[0].feasible == 36
    assert "</html>" in write_report(store).read_text("utf-8")
    assert compare_stores([tmp_path], None).words
    for method, count in {"oat": 5, "morris": 10, "sobol": 16}.items():
        kept = study_store(store, method)
        run_study(study_of(campaign, Asked(method, (), count)), kept, 1, io.StringIO(), "again")
        assert "</html>" in write_study(kept).read_text("utf-8")


def test_results_beyond_are_infinite_and_never_win(tmp_path):
    campaign = parse_campaign(TEXT.format(**USUAL | {"size": 1.7e308}))
    Runner(campaign, tmp_path, 1, io.StringIO()).sample()
    table = pd.read_parquet(tmp_path / "evaluations")
    assert np.isinf(table[["f1", "f2"]]).all(axis=None)
    assert [run.feasible for run in read_status(Store(tmp_path)).runs] == [0, 0]


@pytest.mark.parametrize(
    ("beyond", "place", "words"),
    [
        ({"lower": -1.7e308}, "variables.x1[0]: ", "-1.7e+308 is too large"),
        ({"goal": 1e51}, "objectives.f1.goal: ", "1e+51 is too large"),
        ({"goal": 1e-310}, "objectives.f2.goal: ", "1e-310 is too small"),
        ({"weight": 1.7e308}, "objectives.f1.weight: ", "1.7e+308 is too large"),
        ({"reference": 1e-310}, "reference_point.f2: ", "1e-310 is too small"),
    ],
)
def test_a_campaign_beyond_the_limits_is_refused_in_its_place(beyond, place, words):
    with pytest.raises(FileMistakes) as caught:
        parse_campaign(TEXT.format(**USUAL | beyond))
    assert any(mistake.message.startswith(place + words) for mistake in caught.value.mistakes)
