"""What a slip of the pen is answered: what may have been meant, and where the other thing is."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import toy_model
from divideropt.cli import main
from divideropt.models import Quantity
from toy_model import Toy


@pytest.fixture(name="here")
def _here(tmp_path, monkeypatch):
    """A folder with a campaign and what looks like its store."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "valve.yaml").write_text("name: valve\n", encoding="utf-8")
    store = tmp_path / "results" / "valve"
    (store / "evaluations").mkdir(parents=True)
    (store / "campaign.yaml").write_text("name: valve\n", encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("run results/valve", "results/valve: this is a store, the folder of a campaign's results; its campaign is "),
        ("check valv.yaml", "valv.yaml: there is no such file; did you mean valve.yaml?"),
        ("check other.yaml", "there is no such file; check the name and the folder; `divideropt init` writes"),
        ("evaluate designs.csv", "designs.csv: there is no such file; check the name and the folder\n"),
        ("status valve.yaml", "valve.yaml: no store there (it is a file); name the folder that `divideropt run` has"),
        ("report results/valv", "results/valv: no store there (no campaign.yaml); did you mean results/valve?"),
        ("verify results", "results: no store there (no campaign.yaml), but in it: valve; name one of these"),
        ("export elsewhere", "elsewhere: no store there (no campaign.yaml); name the folder of a store"),
        ("simulate --set spool_radus=9mm", "'spool_radus' is no parameter; did you mean spool_radius?"),
        ("chekc valve.yaml", "No such command 'chekc'"),
        ("check", "Usage: divideropt check [OPTIONS] CAMPAIGN"),
    ],
)
def test_a_slip_is_answered_with_what_may_have_been_meant(here, monkeypatch, capsys, call, words):
    monkeypatch.setattr(sys, "argv", ["divideropt", *call.split()])
    with pytest.raises(SystemExit) as left:
        main()
    said, answered = capsys.readouterr()
    assert (left.value.code, said) == (2, "")
    assert words in answered
    assert "Traceback" not in answered


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_shells_complete(shell, monkeypatch):
    monkeypatch.setenv("_DIVIDEROPT_COMPLETE", f"{shell}_source")
    done = subprocess.run([sys.executable, "-m", "divideropt"], capture_output=True, text=True, check=False)
    assert "_DIVIDEROPT_COMPLETE" in done.stdout, done.stderr
    assert "Traceback" not in done.stderr


def test_commands_options_and_their_choices_are_completed(monkeypatch):
    for words, expected in (
        (["si"], "simulate"),
        (["export", "--f"], "--format"),
        (["init", "--template", "q"], "quickstart"),
    ):
        monkeypatch.setenv("_DIVIDEROPT_COMPLETE", "bash_complete")
        monkeypatch.setenv("COMP_WORDS", " ".join(["divideropt", *words]))
        monkeypatch.setenv("COMP_CWORD", str(len(words)))
        done = subprocess.run([sys.executable, "-m", "divideropt"], capture_output=True, text=True, check=False)
        assert done.stdout.splitlines() == [f"plain,{expected}"], done.stderr


@pytest.fixture(name="one")
def _one(tmp_path, monkeypatch):
    """A campaign of one objective, in the working folder."""
    monkeypatch.chdir(tmp_path)
    path = Path("one.yaml")
    text = """
name: one
model: {kind: "toy_model:Toy", options: {failing_below: -1}}
variables: {x1: [0, 1]}
objectives: {f1: {}}
strategies: {nsga2: {population: 4, generations: 1, seeds: [1]}}
parallel: {backend: sequential}
"""
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(name="divideropt")
def _divideropt(monkeypatch, capsys):
    """`divideropt(call)`: what the program says."""

    def call(words):
        monkeypatch.setattr(sys, "argv", ["divideropt", *words.split()])
        with pytest.raises(SystemExit) as left:
            main()
        said = "".join(capsys.readouterr())
        assert not left.value.code, said
        return said

    return call


@pytest.mark.usefixtures("one")
def test_one_thing_is_not_words_of_several(divideropt):
    calls = ("check one.yaml", "run one.yaml", "run one.yaml", "status results/one", "compare results/one")
    said = "".join(divideropt(call) for call in calls)
    assert "right. 1 run, at most 4 evaluations: nsga2-1" in said
    assert "combined.parquet (1 design)" in said
    assert "nothing to do: 1 of 1 run is done" in said
    assert "one: 1 design on the combined front" in said
    assert "Choosing among 1 design of the best known front" in said
    assert re.findall(r"\b1 \w+s on\b|\b1 (?:designs|runs|evaluations|points)\b", said) == []


@pytest.mark.parametrize(
    "call", ["status LONG", "report LONG", "run one.yaml --store LONG", "simulate --out LONG.csv"]
)
def test_a_name_the_system_refuses_is_a_mistake_of_the_users(tmp_path, monkeypatch, capsys, call):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["divideropt", *call.replace("LONG", "x" * 300).split()])
    with pytest.raises(SystemExit) as left:
        main()
    answered = capsys.readouterr().err
    assert left.value.code == 2
    assert "xxx: File name too long" in answered or "xxx.csv: File name too long" in answered
    assert "Traceback" not in answered


def test_a_run_that_has_not_begun_has_no_empty_brackets(one, divideropt):
    one.write_text(one.read_text(encoding="utf-8").replace("seeds: [1]", "seeds: [1, 2]"), encoding="utf-8")
    divideropt("run one.yaml")
    shutil.rmtree("results/one/evaluations/nsga2-2")
    said = divideropt("status results/one")
    assert "nsga2-1: 4 of 4 evaluations (4 ok)" in said
    assert "nsga2-2: 0 of 4 evaluations\n" in said


def test_check_refuses_names_that_run_would_refuse(one, monkeypatch, capsys):
    class Named(Toy):
        def __init__(self):
            super().__init__()
            self.quantities["batch"] = Quantity("batch", "", "", "a name of the store's", 1.0)

    monkeypatch.setattr(toy_model, "Named", Named, raising=False)
    text = one.read_text(encoding="utf-8").replace('toy_model:Toy", options: {failing_below: -1}', 'toy_model:Named"')
    one.write_text(text, encoding="utf-8")
    for call in ("check one.yaml", "run one.yaml"):
        monkeypatch.setattr(sys, "argv", ["divideropt", *call.split()])
        with pytest.raises(SystemExit) as left:
            main()
        assert left.value.code == 2
        assert "batch: the model gives this name" in capsys.readouterr().err


def test_an_output_without_greek_letters_has_them_as_escapes(tmp_path):
    """And a mistake in a path that goes through a file is a mistake, not the disk's."""
    (tmp_path / "file").touch()
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    call = [sys.executable, "-m", "divideropt"]
    shown = subprocess.run([*call, "schema"], env=environment, capture_output=True, check=True)
    assert json.loads(shown.stdout)["title"] == "divideropt campaign"
    assert b"\\u03bc" in shown.stdout
    wrong = subprocess.run([*call, "status", str(tmp_path / "file" / "x")], capture_output=True, check=False)
    assert wrong.returncode == 2
    assert b"Not a directory; name another path" in wrong.stderr
