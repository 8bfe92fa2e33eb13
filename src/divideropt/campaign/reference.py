"""The problem by which another is verified: the same, simulated by its model's reference."""

from dataclasses import replace

from divideropt.errors import UsageError
from divideropt.models import Model, Verifiable
from divideropt.problem import Problem


def reference_problem(problem: Problem) -> Problem | None:
    """Make the same problem on the model's reference.

    Args:
        problem: What is optimised.

    Returns:
        The problem, or None where the model offers no reference.

    Raises:
        UsageError: A user's own model offers one that fails, or that is another model.
    """
    model = problem.model
    if not isinstance(model, Verifiable):
        return None
    try:
        reference = model.reference()
        same = _names(reference) == _names(model)
    except Exception as error:  # the model may be anybody's
        raise UsageError(
            f"the model's reference() fails ({type(error).__name__}: {error}); mend it, or delete it, and the fronts "
            "say that nothing was verified"
        ) from error
    if not same:
        raise UsageError(
            "the model's reference() has other parameters or quantities than the model; give it the same, in the "
            "same order"
        )
    return replace(problem, model=reference)


def _names(model: Model) -> tuple[list[str], list[str]]:
    return list(model.parameters), list(model.quantities)
