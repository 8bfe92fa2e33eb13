"""How far the runs are, and how long they take yet."""

import io
import json
from dataclasses import asdict
from types import SimpleNamespace

import pytest

from divideropt.campaign.progress import Counter, Display
from divideropt.campaign.standing import Standing, time_left


def standing(run="nsga2-1", done=100, budget=1000, rate=10.0, ended=None):
    return Standing(run, done, budget, 0, rate, None, None, ended)


@pytest.mark.parametrize(
    ("standings", "budgets", "seconds"),
    [
        ([standing()], {"nsga2-1": 1000}, 90.0),
        ([standing()], {"nsga2-1": 1000, "waiting": 600}, 150.0),
        ([standing(), standing("b", 0, 300, 20.0)], {"nsga2-1": 1000, "b": 300}, 90.0),
        ([standing(), standing("b", 90, 100, 10.0)], {"nsga2-1": 1000, "b": 100, "waiting": 2000}, 145.5),
        ([standing(rate=0.0)], {"nsga2-1": 1000}, None),
        ([], {"nsga2-1": 1000}, None),
        ([standing(ended="done")], {"nsga2-1": 1000}, 0.0),
    ],
)
def test_what_is_left_is_what_all_take_together_or_the_slowest_alone(standings, budgets, seconds):
    assert time_left(standings, budgets) == seconds


@pytest.mark.parametrize(
    ("rate", "words"),
    [(100.0, "9 s left"), (10.0, "1 min 30 s left"), (0.5, "30 min left"), (0.1, "2 h 30 min left")],
)
def test_a_line_says_how_long_at_most(tmp_path, rate, words):
    (tmp_path / "nsga2-1.json").write_text(json.dumps(asdict(standing(rate=rate))), encoding="utf-8")
    stream = io.StringIO()
    with Display(tmp_path, {"nsga2-1": 1000}, stream):
        pass
    run, together = stream.getvalue().splitlines()
    assert f"/s, {words} at most, best max" in run
    assert together == f"all runs: {words} at most"


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize("given", [True, False])
def test_no_color_is_honoured_on_a_terminal(tmp_path, monkeypatch, given):
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    if given:
        monkeypatch.setenv("NO_COLOR", "1")
    (tmp_path / "nsga2-1.json").write_text(json.dumps(asdict(standing())), encoding="utf-8")
    stream = Terminal()
    with Display(tmp_path, {"nsga2-1": 1000}, stream) as display:
        display._console.print("[red]red[/red]")
    coloured = "\x1b[31m" in stream.getvalue()
    assert coloured is not given
    assert "1 min 30 s" in stream.getvalue()


@pytest.mark.parametrize(
    ("stream", "variables"),
    [(io.StringIO(), {"FORCE_COLOR": "1", "TERM": "xterm-256color"}), (Terminal(), {"TERM": "dumb"})],
    ids=["a pipe whose colours are forced", "a dumb terminal"],
)
def test_lines_are_written_where_nothing_can_be_painted_over(tmp_path, monkeypatch, stream, variables):
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    (tmp_path / "nsga2-1.json").write_text(json.dumps(asdict(standing(done=1000, ended="done"))), encoding="utf-8")
    with Display(tmp_path, {"nsga2-1": 1000}, stream):
        pass
    with Counter("{} of {} again", 2, stream) as counter:
        counter.advance()
        counter.advance()
    assert "\x1b" not in stream.getvalue()
    assert stream.getvalue().splitlines() == [
        "nsga2-1: 1000 of 1000 evaluations (done), 10/s, best max λ –, hypervolume –",
        "2 of 2 again",
    ]


def test_a_run_that_was_only_replayed_has_no_rate(tmp_path):
    (tmp_path / "nsga2-1.json").write_text(
        json.dumps(asdict(Standing("nsga2-1", 1000, 1000, 1000, 0.0, None, None, "done"))), encoding="utf-8"
    )
    stream = io.StringIO()
    with Display(tmp_path, {"nsga2-1": 1000}, stream):
        pass
    assert stream.getvalue() == (
        "nsga2-1: 1000 of 1000 evaluations, 1000 from the log (done), best max λ –, hypervolume –\n"
    )


def test_a_count_says_how_long_it_takes_yet(monkeypatch):
    clock = iter([0.0, 100.0, 100.0, 200.0])
    monkeypatch.setattr("divideropt.campaign.progress.time", SimpleNamespace(monotonic=lambda: next(clock)))
    stream = io.StringIO()
    with Counter("{} of {} done", 2, stream) as counter:
        counter.advance()
        counter._count += 1
    assert stream.getvalue().splitlines() == ["1 of 2 done, 1 min 40 s left", "2 of 2 done"]
