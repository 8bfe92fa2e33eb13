"""A word when compilation begins: it takes seconds, once for each version of the package, and looks like a hang."""

from contextlib import suppress
from typing import Any, TextIO

from numba.core import event

WORDS = "compiling the model, once for this version; it may take half a minute …"


def say_when_compiling(words: TextIO) -> None:
    """Say so when this process first compiles something, and nothing where all is in the cache."""
    event.register("numba:compile", _Sayer(words))


class _Sayer(event.Listener):  # type: ignore[misc]
    """Hears the compiler, which is silent where a cached function is loaded."""

    def __init__(self, words: TextIO) -> None:
        self._words = words
        self._said = False

    def on_start(self, event: Any) -> None:
        """Hear that a compilation begins."""
        if not self._said:
            self._said = True
            with suppress(ValueError):  # a stream that has been closed since
                print(WORDS, file=self._words, flush=True)

    def on_end(self, event: Any) -> None:
        """Hear that it ends."""
