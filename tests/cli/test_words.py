"""What a slip of the pen is answered: what may have been meant, and where the other thing is."""

import subprocess
import sys

import pytest

from divideropt.cli import main


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
