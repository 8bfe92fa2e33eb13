"""A batch of designs through one scenario, in one compiled loop.

It goes the straight way: rests by Newton, if need be from where the valve goes when it is let go, and responses by
the Rosenbrock method. A design that leaves it, because a rest is not found or a response not completed, is left to
`respond`, which knows other ways.
"""

import math

from divideropt.models.divider.coefficient_kernels import apply_span, prepare
from divideropt.models.divider.metric_kernels import measure_course
from divideropt.models.divider.rest_kernels import centred_state, polish
from divideropt.models.divider.result_record import LIMIT_CYCLE, NOT_FOLLOWED
from divideropt.models.divider.run_kernels import let_go, run
from divideropt.models.divider.states import STATES
from divideropt.models.divider.verdict_kernels import judge_course
from divideropt.ode.compiled import compiled
from divideropt.ode.rosenbrock import FINISHED, TAKEN

_X = STATES.index("x")
_FROZEN, _NO_STOP = 1, 2


@compiled
def simulate_batch(rows, options, course, blank, settings, work, found, low, high):  # type: ignore[no-untyped-def]
    """Simulate, measure and judge.

    Args:
        rows: `PARAMETER_ROW`, shape (n,).
        options: `OPTIONS`, shape (1,).
        course: A `Course` with room for the steps of all phases and `RELAXATION_STEPS` more; work.
        blank: `COEFFICIENTS`, shape (1,); work.
        settings: Relative tolerance; absolute tolerance a state, shape (9,), without Coulomb friction and with it;
            budget of steps a phase.
        work: The arrays s, k, y, u, U of a `Workspace`.
        found: `WHOLE`, `BY_EVENT` and `JUDGEMENT` as `Findings` has them; the designs' receive what is found.
        low: First design.
        high: First that is not looked at.
    """
    whole, by_event, judgements = found
    for i in range(low, high):
        course.row[0] = rows[i]
        if not _follow(options, course, blank, settings, work):
            judgements[i].finding = NOT_FOLLOWED
            continue
        measure_course(course, whole, by_event, i)
        judge_course(course, whole, by_event, judgements, i)
        if judgements[i].finding == LIMIT_CYCLE:  # its sentence needs the response
            judgements[i].finding = NOT_FOLLOWED


@compiled
def _follow(options, course, blank, settings, work):  # type: ignore[no-untyped-def]
    """Fill the course of one design; return whether the straight way was enough."""
    prepare(course.row, options, course.derived, blank)
    friction = course.row[0].coulomb_friction
    for phase in range(course.spans.size):
        design = course.designs[phase : phase + 1]
        design[0] = blank[0]
        apply_span(course.row, course.spans, phase, course.rules[0].sized_for, design)
        moving = course.spans[phase].moving != 0
        if phase == 0 and course.rules[0].settled != 0:
            course.first[0] = course.first[1] = 0
            if not _find_rest(course, phase, design, centred_state(design), work):
                return False
            course.ends[0] = course.rests[0]
        else:
            if not _run_phase(course, phase, design, settings, work):
                return False
            if not moving and not _find_rest(course, phase, design, course.ends[phase], work):
                return False
        course.reached[phase], course.rested[phase] = 1, 0 if moving else 1
        course.banded[phase] = 0
        if friction > 0.0 and not moving and not _find_band(course, phase, design, friction):
            return False
    return True


@compiled
def _find_rest(course, phase, design, start, work):  # type: ignore[no-untyped-def]
    """Find the rest near a state, or near where the valve goes from there; return whether there is one."""
    s, k, _, u, increments = work
    rest, spare = course.rests[phase], course.first[phase + 1]  # what lies behind the last edge is free
    rest[:] = start
    if polish(design, rest) < math.inf:
        return True
    rest[:] = start
    let_go(design, rest, s, k, u, increments, course.edges[spare + 1 :], course.values[spare:])
    return polish(design, rest) < math.inf


@compiled
def _run_phase(course, phase, design, settings, work):  # type: ignore[no-untyped-def]
    """Integrate one phase from the end of the one before; return whether it came to its end."""
    rtol, atol_free, atol_sticky, limit = settings
    s, k, y, u, increments = work
    first, d = course.first[phase], design[0]
    for i in range(y.size):
        y[i] = 0.0 if phase == 0 else course.ends[phase - 1, i]
    atol = atol_sticky if d.coulomb_friction > 0.0 else atol_free
    frozen = d.stop == _FROZEN
    if frozen and abs(y[_X]) >= d.stop_position:
        return False
    if frozen:  # up to the stop it is as if there were none
        d.stop = _NO_STOP
    bound = d.stop_position if frozen else math.inf
    span = course.spans[phase]
    ending = run(
        design, span.begin, span.end, limit, s, k, y, u, increments, rtol, atol, bound,
        course.edges[first:], course.values[first:],
    )  # fmt: skip
    if frozen:
        d.stop = _FROZEN
    course.first[phase + 1] = first + k[TAKEN]
    for i in range(y.size):
        course.ends[phase, i] = y[i]
    return ending == FINISHED


@compiled
def _find_band(course, phase, design, friction):  # type: ignore[no-untyped-def]
    """Find the rests at which Coulomb friction holds to one side and to the other."""
    d = design[0]
    fine = True
    for side in range(2):
        d.coulomb_friction, d.extra_force = 0.0, friction if side == 1 else -friction
        course.bands[phase, side] = course.ends[phase]
        fine = polish(design, course.bands[phase, side]) < math.inf and fine
    d.coulomb_friction, d.extra_force = friction, 0.0
    course.banded[phase] = 1
    return fine
