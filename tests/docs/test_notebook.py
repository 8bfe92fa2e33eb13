"""The blocks of the page for notebooks run, one after the other, and say what they are to say."""

import contextlib
import io
import re
import shutil
from pathlib import Path

import pandas as pd
import plotly.graph_objects as go
import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "how-to" / "notebook.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module", name="notebook")
def _notebook(tmp_path_factory):
    """What the page's names stand for in the end, and what it printed."""
    folder, printed, names = tmp_path_factory.mktemp("notebook"), io.StringIO(), {}
    shutil.copytree(ROOT / "campaigns", folder / "campaigns")
    with contextlib.chdir(folder), contextlib.redirect_stdout(printed):
        for block in re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE):
            exec(compile(block, "notebook.md", "exec"), names)
    return names, printed.getvalue()


def test_the_front_has_units_and_is_drawn(notebook):
    names, printed = notebook
    assert names["units"]["spool_radius"] == "m"
    assert "spool_radius           r        [m]" in printed
    assert isinstance(names["figure"], go.Figure)
    assert [type(trace) for trace in names["figure"].data] == [go.Scatter3d] * 2
    assert sum(len(trace.x) for trace in names["pair"].data) == len(names["front"])
    assert names["pair"].layout.xaxis.title.text == "steady state error [%]"


def test_a_design_of_the_front_comes_out_the_same_and_a_narrower_groove_does_not(notebook):
    names, _ = notebook
    value = names["response"].quantities.loc["steady_state_error", "value"]
    assert value == names["best"]["steady_state_error"]
    assert names["narrower"].quantities.loc["steady_state_error", "value"] != value
    assert names["narrower"].parameters.loc["groove_width", "value"] == pytest.approx(0.7e-3, rel=1e-15)


def test_tables_are_of_the_designs_that_were_given(notebook):
    names, printed = notebook
    pd.testing.assert_series_equal(names["thicker"]["spool_radius"], names["designs"]["spool_radius"])
    assert names["thicker"].attrs["units"]["dynamic_error"] == "m^3"
    assert "hypervolume" in printed
    assert set(names["mu_star"]["variable"]) >= set(names["results"].variables)
    assert len(names["drawn"].data) == len(names["results"].objectives)


def test_what_was_exported_is_evaluated_again_to_the_same(notebook):
    names, _ = notebook
    for objective in names["results"].objectives:
        assert names["again"][objective].tolist() == names["front"][objective].tolist()


def test_what_goes_wrong_is_said(notebook):
    assert "--set spool_radius=9: 9 has no unit; write 9 m" in notebook[1]
