"""A guard against generators that nobody seeded: while it stands, what draws from one fails.

Whoever makes a generator of NumPy's without a seed asks `numpy.random.bit_generator.randbits` for one, by whatever
name and reference it is made; so that is where it is caught. The generators that a process has from its beginning are
caught by their functions, and by their state, which nothing may have moved, where a function was imported before.
"""

import os
import random
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any, NoReturn
from unittest.mock import patch

import numpy as np
from numpy.random import _pickle, bit_generator

KEEPERS = {"get_state", "set_state", "getstate", "setstate", "get_bit_generator", "set_bit_generator"}
"""Functions of the generators a process begins with that draw nothing."""


class UnseededError(AssertionError):
    """Something drew from a generator without a seed."""


@contextmanager
def seeded_only() -> Iterator[None]:
    """Fail whatever draws from a generator without a seed, at once, and at the end too if it was swallowed.

    Raises:
        UnseededError: Something drew.
    """
    found: list[str] = []

    def forbidden(name: str) -> Callable[..., NoReturn]:
        def refuse(*_: Any, **__: Any) -> NoReturn:
            found.append(name)
            raise UnseededError(f"{name} was used, which no seed governs")

        return refuse

    legacy = [n for n in dir(np.random) if getattr(getattr(np.random, n), "__self__", None) is np.random.mtrand._rand]
    builtin = [n for n in dir(random) if getattr(getattr(random, n), "__self__", None) is random._inst]
    seed = random.Random.seed

    def checked_seed(self: random.Random, a: Any = None, version: int = 2) -> None:
        if a is None:
            forbidden("random.Random without a seed")()
        seed(self, a, version)

    whole, seeded = np.random.RandomState, [False]

    def checked_randbits(_: int) -> int:
        if not seeded[0]:
            forbidden("a generator of NumPy's without a seed")()
        return 0

    class CheckedRandomState(whole, metaclass=_AsBefore):
        """Seeds itself at random before it takes the seed it is given."""

        def __init__(self, seed: Any = None) -> None:
            seeded[0] = seed is not None
            try:
                super().__init__(seed)
            finally:
                seeded[0] = False

    made = _pickle.__bit_generator_ctor

    def copied(*arguments: Any) -> Any:
        """A copy is made without a seed too, and then given the state of what it is copied from."""
        seeded[0] = True
        try:
            return made(*arguments)
        finally:
            seeded[0] = False

    before = _states()
    with ExitStack() as stack:
        for module, names in ((np.random, legacy), (random, builtin)):
            for name in sorted(set(names) - KEEPERS):
                stack.enter_context(patch.object(module, name, forbidden(f"{module.__name__}.{name}")))
        stack.enter_context(patch.object(bit_generator, "randbits", checked_randbits))
        stack.enter_context(patch.object(_pickle, "__bit_generator_ctor", copied))
        stack.enter_context(patch.object(np.random, "RandomState", CheckedRandomState))
        stack.enter_context(patch.object(os, "urandom", forbidden("os.urandom")))
        stack.enter_context(patch.object(random, "_urandom", forbidden("random.SystemRandom")))
        stack.enter_context(patch.object(random.Random, "seed", checked_seed))
        yield
    if _states() != before:
        found.append("a generator that the process began with")
    if found:
        raise UnseededError(f"used, which no seed governs: {', '.join(dict.fromkeys(found))}")


class _AsBefore(type):
    """Calls an instance of its class what is one of that class's parent."""

    def __instancecheck__(cls, instance: object) -> bool:
        return isinstance(instance, cls.__mro__[1])


def _states() -> tuple[object, ...]:
    """Where the generators stand that a process begins with."""
    kind, keys, position, has_gauss, gauss = np.random.mtrand._rand.get_state()
    return kind, keys.tobytes(), position, has_gauss, gauss, random.getstate()
