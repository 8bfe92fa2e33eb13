"""The contest's numbers as tables in Markdown."""

from collections.abc import Iterator, Sequence

import pandas as pd

from divideropt.analysis import holm, pair_tests

from .cases import VALVE
from .contest import Contest
from .measures import COUNT, HV, HV_BEST, IGD, LAMBDA_MEAN, LAMBDA_WORST, TIME
from .players import PLAIN

SIGNIFICANT = 0.05

SIGN = {HV: 1.0, HV_BEST: 1.0, IGD: -1.0, LAMBDA_MEAN: -1.0, LAMBDA_WORST: -1.0}
"""Whether more is better."""

WORDS = {
    HV: "hypervolume", HV_BEST: "hypervolume of the best 500", IGD: "IGD+", LAMBDA_MEAN: "λ, mean excess",
    LAMBDA_WORST: "λ, worst excess",
}  # fmt: skip


def valve_tables(contest: Contest, values: pd.DataFrame) -> Iterator[str]:
    """Say how the players did on the valve: hypervolume, λ, and the rank tests."""
    of = values[values["case"] == VALVE]
    marks = [*map(str, contest.marks), TIME]
    plain = of[(of["player"] == PLAIN) & (of["measure"] == HV) & (of["mark"] == str(contest.plain_evaluations))][
        "value"
    ]
    unit = float(plain.median())
    yield (
        f"Hypervolume in % of that of plain NSGA-II after {contest.plain_evaluations:,} evaluations, which\n"
        f"is {unit:.6f} of the box between the origin and the reference point of `divider.yaml`: median\n"
        f"and quartiles over {len(contest.seeds)} seeds. Equal time is {contest.equal_time(VALVE):.2f} s;\n"
        "beside it, how many evaluations the player had by then (median)."
    )
    columns = [(HV, mark) for mark in marks] + [(HV_BEST, marks[-2])]
    heads = [*(_words(mark) for mark in marks), "evaluations", f"best 500 of {_words(marks[-2])}"]
    rows = []
    for player in contest.players:
        cells = [_quartiles(_sample(of, player, *column) / unit * 100.0, 2) for column in columns]
        rows.append([_bold(player, contest), *cells[:-1], _median(_sample(of, player, COUNT, TIME)), cells[-1]])
    yield _table(["player", *heads], rows)
    if (of["measure"] == LAMBDA_MEAN).any():
        yield (
            "λ over the goal directions: how far the best point of the archive lies above the direction's\n"
            "optimum [%], mean over the directions / worst direction; medians over the seeds."
        )
        rows = [[_bold(player, contest), *(_pair(of, player, mark) for mark in marks)] for player in contest.players]
        yield _table(["player", *map(_words, marks)], rows)
        lambdas = _pair(of, PLAIN, str(contest.plain_evaluations))
        yield f"Plain NSGA-II after {contest.plain_evaluations:,} evaluations: {lambdas}."
    tests = compared(contest, of)
    yield (
        f"`{contest.champion}` against each: the chance A12 that one of its runs is better than one of the\n"
        f"other's, and p of the rank-sum test, two-sided, Holm-corrected for all {len(tests)} tests on the\n"
        "valve."
    )
    for measure in SIGN:
        here = tests[tests["measure"] == measure]
        if not here.empty:
            shown = [mark for mark in marks if (here["mark"] == mark).any()]
            rows = [
                [player, *(_test_cell(here, player, mark) for mark in shown)]
                for player in contest.players
                if player != contest.champion
            ]
            yield _table([WORDS[measure], *map(_words, shown)], rows)


def known_tables(contest: Contest, values: pd.DataFrame) -> Iterator[str]:
    """Say how the players did on the test problems."""
    of = values[values["case"] != VALVE]
    tests = compared(contest, of)
    names = [name for name in contest.players if (of["player"] == name).any()]
    yield (
        f"Medians over {len(contest.known_seeds)} seeds. + where `{contest.champion}` is better than the\n"
        f"player, − where it is worse (rank-sum test, two-sided, p < {SIGNIFICANT:g}, Holm-corrected for\n"
        f"all {len(tests)} tests on these problems)."
    )
    for measure, mark in [*((m, str(mark)) for m in (HV, IGD) for mark in contest.marks), (HV, TIME)]:
        scale, digits = (100.0, 2) if measure == HV else (1.0, 4)
        words = "Hypervolume in % of the known front's" if measure == HV else "IGD+ of normalised objectives"
        yield f"{words}, {_words(mark)}{'' if mark == TIME else ' evaluations'}:"
        shown = [name for name in names if len(_sample(of, name, measure, mark))]
        rows = []
        for case in contest.cases:
            if case != VALVE:
                here = of[of["case"] == case]
                cells = [
                    _number(_sample(here, name, measure, mark) * scale, digits)
                    + _verdict(tests, case, name, measure, mark)
                    for name in shown
                ]
                rows.append([case, *cells])
        yield _table(["problem", *(_bold(name, contest) for name in shown)], rows)
    yield f"How often `{contest.champion}` is better / not told apart / worse, over the problems:"
    marks = [*map(str, contest.marks), TIME]
    columns = [(measure, mark) for measure in (HV, IGD) for mark in marks] + [(HV_BEST, marks[-2])]
    rows = [
        [name, *(_score(tests, name, *column) for column in columns)] for name in names if name != contest.champion
    ]
    yield _table(["player", *(f"{WORDS[measure]}, {_words(mark)}" for measure, mark in columns)], rows)


def beyond(values: pd.DataFrame) -> float:
    """Return the greatest hypervolume found, in shares of the known front's: above 1 the front would be wrong."""
    known = values[(values["case"] != VALVE) & (values["measure"] == HV)]
    return float(known["value"].max())


def players_table(contest: Contest) -> str:
    """Say who plays with which settings."""
    rows = [
        [_bold(name, contest), player.settings, "valve" if not player.everywhere else "all", f"{player.most or ''}"]
        for name, player in contest.players.items()
    ]
    return _table(["player", "settings", "problems", "most evaluations"], rows)


def compared(contest: Contest, of: pd.DataFrame) -> pd.DataFrame:
    """Test the champion against each other player, by case, measure and mark, where both have two runs at least.

    p is corrected for all of these tests.

    Returns:
        Columns case, player, measure, mark, p, a12: the chance that the champion's run is the better.
    """
    found = []
    marks = [*map(str, contest.marks), TIME]
    chosen = of[of["measure"].isin(list(SIGN)) & of["mark"].isin(marks)]
    for key, group in chosen.groupby(["case", "measure", "mark"], sort=False):
        case, measure, mark = map(str, key)
        samples = {str(name): (SIGN[measure] * rows["value"]).tolist() for name, rows in group.groupby("player")}
        ours = samples.pop(contest.champion, [])
        for player, theirs in samples.items():
            [test] = pair_tests({contest.champion: ours, player: theirs})
            if test.p is not None:
                found.append([case, player, measure, mark, test.p, test.effect])
    tests = pd.DataFrame(found, columns=["case", "player", "measure", "mark", "p", "a12"])
    return tests.assign(p=holm(tests["p"].tolist()))


def _sample(of: pd.DataFrame, player: str, measure: str, mark: str) -> "pd.Series[float]":
    return of[(of["player"] == player) & (of["measure"] == measure) & (of["mark"] == mark)]["value"]


def _quartiles(sample: "pd.Series[float]", digits: int) -> str:
    if sample.empty:
        return ""
    low, middle, high = (sample.quantile(q) for q in (0.25, 0.5, 0.75))
    return f"{middle:.{digits}f} ({low:.{digits}f}–{high:.{digits}f})"


def _number(sample: "pd.Series[float]", digits: int) -> str:
    return "" if sample.empty else f"{sample.median():.{digits}f}"


def _median(sample: "pd.Series[float]") -> str:
    return "" if sample.empty else f"{sample.median():,.0f}"


def _pair(of: pd.DataFrame, player: str, mark: str) -> str:
    mean, worst = (_sample(of, player, measure, mark) for measure in (LAMBDA_MEAN, LAMBDA_WORST))
    return "" if mean.empty else f"{mean.median() * 100:.1f} / {worst.median() * 100:.0f}"


def _test(tests: pd.DataFrame, case: str, player: str, measure: str, mark: str) -> "pd.DataFrame":
    rows = (tests["case"] == case) & (tests["player"] == player)
    return tests[rows & (tests["measure"] == measure) & (tests["mark"] == mark)]


def _test_cell(here: pd.DataFrame, player: str, mark: str) -> str:
    row = here[(here["player"] == player) & (here["mark"] == mark)]
    return "" if row.empty else f"{row['a12'].iloc[0]:.2f}, {_p(row['p'].iloc[0])}"


def _p(p: float) -> str:
    return f"{p:.0e}" if p < 1e-3 else f"{p:.2g}"


def _verdict(tests: pd.DataFrame, case: str, player: str, measure: str, mark: str) -> str:
    row = _test(tests, case, player, measure, mark)
    if row.empty or row["p"].iloc[0] >= SIGNIFICANT:
        return ""
    return " +" if row["a12"].iloc[0] > 0.5 else " −"


def _score(tests: pd.DataFrame, player: str, measure: str, mark: str) -> str:
    cases = tests["case"].unique()
    verdicts = [_verdict(tests, case, player, measure, mark) for case in cases]
    if all(_test(tests, case, player, measure, mark).empty for case in cases):
        return ""
    return f"{verdicts.count(' +')} / {verdicts.count('')} / {verdicts.count(' −')}"


def _words(mark: str) -> str:
    return "equal time" if mark == TIME else f"{int(mark):,}"


def _bold(player: str, contest: Contest) -> str:
    return f"**{player}**" if contest.players[player].ours else player


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
