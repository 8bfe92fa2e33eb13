"""What Chapter 4 says its tests show, judged by the model under each of several assumptions."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

from claims.experiment import ASSUMED, CASES, Assumptions, Point, measure
from claims.judgement import Answer, Judgement
from claims.resolution import steady_bias
from divideropt.models.base import Outcome
from divideropt.models.divider import rig

TABLE_1 = tuple((row.fixed_drop, row.load_difference) for row in rig.TABLE_4_1)
TABLE_2 = tuple((row.fixed_drop, row.load_difference) for row in rig.TABLE_4_2)
FIRST_TEST = (427e3, 1.640e6)
"""Drop and load difference of section 4.3 [Pa]."""

PRECISE = 5.0
"""What section 1.2 calls high precision [%]."""

HIGHEST_ERROR = 1.5
"""What section 4.8 says no test reached [%]."""

INVERSE = (-1.1, -0.9)
"""Exponents of an error inversely proportional to the drop."""

POSITIONS = (0.3, 0.4, 0.5, 0.6, 0.7)
"""φ/φ0 where the rotation is judged; the rig's own are not stated."""

Rows = tuple[Point, ...]


@dataclass(frozen=True)
class Tests:
    """The model's answers to all tests under one set of assumptions.

    Attributes:
        first: To section 4.3.
        drops: To Table 4.1.
        loads: To Table 4.2.
        rotated: To Figure 4.8, at `POSITIONS`.
    """

    first: Point
    drops: Rows
    loads: Rows
    rotated: Rows


@dataclass(frozen=True)
class Trend:
    """Something Chapter 4 says of its measurements.

    Attributes:
        quotation: In a few words of its own.
        place: Table, figure or section.
        criterion: When the answer is yes, when in part; why there is none, where nothing judges it.
        judge: Gives the answer of one formulation; None where the model cannot.
    """

    quotation: str
    place: str
    criterion: str
    judge: Callable[[str], Judgement] | None = None

    def judged(self, formulation: str) -> Judgement:
        """Judge it by the runs of one formulation."""
        return Judgement(Answer.NOT_JUDGED, "") if self.judge is None else self.judge(formulation)


@cache
def run_tests(formulation: str, case: Assumptions) -> Tests:
    """Run every test under one set of assumptions."""
    rotation = ((rig.ROTATION_FIXED_DROP, rig.ROTATION_LOAD_DIFFERENCE),)
    return Tests(
        first=measure(formulation, case, (FIRST_TEST,))[0],
        drops=tuple(measure(formulation, case, TABLE_1)),
        loads=tuple(measure(formulation, case, TABLE_2)),
        rotated=tuple(measure(formulation, case, rotation, position)[0] for position in POSITIONS),
    )


def _in_each_case(judge: Callable[[Tests], Answer]) -> Callable[[str], Judgement]:
    """Judge every case: yes or no where all agree, else in part, with the cases that differ."""

    def judged(formulation: str) -> Judgement:
        answers = {case.name: judge(run_tests(formulation, case)) for case in CASES}
        kinds = set(answers.values())
        if len(kinds) == 1:
            return Judgement(kinds.pop(), f"in all {len(answers)} cases")
        counts = []
        for kind in (Answer.YES, Answer.IN_PART, Answer.NO):
            names = [name for name, answer in answers.items() if answer is kind]
            listed = f" ({', '.join(names)})" if len(names) <= len(answers) // 2 else ""
            counts += [f"{kind} in {len(names)}{listed}"] if names else []
        return Judgement(Answer.IN_PART, "; ".join(counts))

    return judged


def _compensates(tests: Tests) -> Answer:
    return _yes(tests.first.outcome is Outcome.OK and abs(tests.first.error) <= PRECISE)


def _error_falls_with_drop(tests: Tests) -> Answer:
    low, *higher = (abs(point.error) for point in tests.drops)
    return _yes(all(error < low for error in higher))


def _dynamic_falls_with_drop(tests: Tests) -> Answer:
    return _yes(_descends([abs(point.dynamic) for point in tests.drops]))


def _bought(tests: Tests) -> Answer:
    losses = [point.loss for point in tests.drops]
    return _part(_descends([-loss for loss in losses]), _error_falls_with_drop(tests) is Answer.YES)


def _inverse(tests: Tests) -> Answer:
    exponent = realised_exponent(tests)
    return Answer.YES if INVERSE[0] <= exponent <= INVERSE[1] else Answer.IN_PART if exponent < 0 else Answer.NO


def _error_rises_with_load(tests: Tests) -> Answer:
    return _yes(_descends([-abs(point.error) for point in tests.loads]))


def _dynamic_rises_with_load(tests: Tests) -> Answer:
    low, *higher = (abs(point.dynamic) for point in tests.loads)
    return _part(*(dynamic > low for dynamic in higher))


def _signs(tests: Tests) -> Answer:
    return _part(all(p.error > 0 for p in tests.drops), all(p.dynamic < 0 for p in tests.drops))


def _sizes(tests: Tests) -> Answer:
    pairs = zip((*rig.TABLE_4_1, *rig.TABLE_4_2), (*tests.drops, *tests.loads), strict=True)
    return _part(*(abs(abs(row.steady_error) - abs(point.error)) <= steady_bias() for row, point in pairs))


def _below_limit(tests: Tests) -> Answer:
    return _yes(all(abs(point.error) < HIGHEST_ERROR for point in (*tests.drops, *tests.loads)))


def _rotates(tests: Tests) -> Answer:
    ratios = [point.ratio for point in tests.rotated]
    apart = abs(tests.rotated[0].error - tests.rotated[-1].error) > 2 * steady_bias()
    return _yes(_descends(ratios) and apart)


def _slower_with_volume(formulation: str) -> Judgement:
    """Judge whether larger volumes slow the valve."""
    small, large = (
        run_tests(formulation, case).drops for case in CASES if case.name in ("volumes × 1", "volumes × 100")
    )
    slower = [b.settling > a.settling for a, b in zip(small, large, strict=True)]
    figures = ", ".join(
        f"{1e3 * a.settling:.0f} → {1e3 * b.settling:.0f} ms" for a, b in zip(small, large, strict=True)
    )
    return Judgement(_part(*slower), figures)


def _kwans_rule(formulation: str) -> Judgement:
    cases = _in_each_case(_inverse)(formulation)
    exponent = realised_exponent(assumed(formulation))
    return Judgement(cases.answer, f"{cases.figures}; the power {exponent:.2f} as assumed")


def realised_exponent(tests: Tests) -> float:
    """Return the power of the realised drop with which the error goes over Table 4.1."""
    return drop_exponent([point.error for point in tests.drops], [point.drop for point in tests.drops])


def drop_exponent(errors: Sequence[float], drops: Sequence[float]) -> float:
    """Return the power of the drop with which the magnitude of an error goes, from the first row to the last."""
    return math.log(abs(errors[-1] / errors[0])) / math.log(drops[-1] / drops[0])


def _descends(values: Sequence[float]) -> bool:
    return all(later < earlier for earlier, later in pairwise(values))


def _yes(shown: bool) -> Answer:
    return Answer.YES if shown else Answer.NO


def _part(*shown: bool) -> Answer:
    return Answer.YES if all(shown) else Answer.IN_PART if any(shown) else Answer.NO


TRENDS: tuple[Trend, ...] = (
    Trend(
        "the valve attempted to equalize [the flows] after the load disturbance",
        "section 4.3",
        "At 427 kPa and 1640 kPa: yes if it settles with an error of at most 5 % (section 1.2: “high precision”).",
        _in_each_case(_compensates),
    ),
    Trend(
        "the steady state error decreased from 1.23% to 0.73% as the pressure drop increased",
        "Table 4.1",
        "Yes if the errors at 430 and 1459 kPa are below that at 154 kPa in magnitude (the rig does not tell 430 "
        "from 1459).",
        _in_each_case(_error_falls_with_drop),
    ),
    Trend(
        "the accumulated dynamic error decreased from −0.71 to −0.39 L",
        "Table 4.1",
        "Order alone: yes if its magnitude falls from row to row.",
        _in_each_case(_dynamic_falls_with_drop),
    ),
    Trend(
        "accuracy can be obtained, but at the cost of efficiency",
        "section 4.5",
        "Yes if from row to row of Table 4.1 the pressure loss rises and the error falls as above; in part if one "
        "does.",
        _in_each_case(_bought),
    ),
    Trend(
        "the steady state error increased with load pressure difference",
        "Table 4.2",
        "Yes if its magnitude rises from row to row (the rig tells all three apart).",
        _in_each_case(_error_rises_with_load),
    ),
    Trend(
        "(the dynamic error: −0.348, −0.430, −0.425 L)",
        "Table 4.2",
        "Order alone: yes if at 1649 and 3350 kPa it is larger than at 679 kPa; in part if at one of them.",
        _in_each_case(_dynamic_rises_with_load),
    ),
    Trend(
        "(signs: steady error positive, dynamic error negative, though load 1 drops)",
        "Table 4.1",
        "Yes if (3.5) and (3.10) have these signs in all three rows; in part if one of the two has.",
        _in_each_case(_signs),
    ),
    Trend(
        "(sizes of the steady-state errors)",
        "Tables 4.1, 4.2",
        "Yes if all six magnitudes are within the rig’s bias of those measured, in part if some are. A weak test: "
        "the bias exceeds the errors.",
        _in_each_case(_sizes),
    ),
    Trend(
        "[the steady state error] was less than 1.5% for all tests",
        "section 4.8",
        "Yes if all six rows’ magnitudes are below 1.5 %.",
        _in_each_case(_below_limit),
    ),
    Trend(
        "(sizes of the dynamic errors: 0.35 to 0.71 L)",
        "Tables 4.1, 4.2",
        "Not explained, and not judged: see the arithmetic below.",
    ),
    Trend(
        "greatly increased the involved volumes (slowing performance)",
        "section 4.1",
        "Yes if in all three rows of Table 4.1 settling takes longer with volumes × 100 than × 1; in part if in "
        "some.",
        _slower_with_volume,
    ),
    Trend(
        "the ratio of outlet flows can be adjusted",
        "Fig. 4.8",
        "Yes if QL1/QL2 falls throughout from φ/φ0 = 0.3 to 0.7, as (2.6) does, by more than twice the rig’s bias. "
        "The angle of the test and the flows of the figure are not printed: direction alone.",
        _in_each_case(_rotates),
    ),
    Trend(
        "any pressure losses in the long pilot line … caused the ratio to tend toward 50:50",
        "section 4.7",
        "Not judged: no formulation has a pilot line. The ideal analysis with one agrees: see below.",
    ),
)
"""What Chapter 4 says, in its order."""

KWAN = Trend(
    "For a typical divider valve, the steady state error is inversely proportional to the pressure drop across the "
    "fixed orifice (Kwan, 1978). Although the proposed valve has a different configuration, there is a similar "
    "relationship.",
    "section 3.2",
    "Over the rows of Table 4.1: yes if the error goes with the realised drop to the power −0.9 to −1.1, in part if "
    "it falls. How similar a “similar relationship” is, the thesis does not say.",
    _kwans_rule,
)
"""What section 3.2 says of the drop whose effect Table 4.1 measures."""


def assumed(formulation: str) -> Tests:
    """Return the tests under the first set of assumptions."""
    return run_tests(formulation, ASSUMED)
