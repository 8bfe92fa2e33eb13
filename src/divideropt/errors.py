"""The mistakes the platform can name, each with the exit code of its command.

An error here is the caller's to mend; its text says the value, the limit, the reason, the place and the
remedy. A simulation that fails is not an error but a value: see `divideropt.models.base.Outcome`.
"""

from dataclasses import dataclass


class DivideroptError(Exception):
    """Base of every error a user may see as one sentence instead of a traceback."""

    exit_code: int = 1


class UsageError(DivideroptError):
    """The call is wrong: a file that is not there, a column that nobody knows, a value out of its domain."""

    exit_code = 2


@dataclass(frozen=True)
class Mistake:
    """One thing wrong in a file, with its place.

    Attributes:
        line: Line, from 1.
        column: Column, from 1.
        message: What is wrong and what would be right.
    """

    line: int
    column: int
    message: str


class FileMistakes(UsageError):
    """Everything wrong with one file, in the order of its lines."""

    def __init__(self, path: str, mistakes: list[Mistake]) -> None:
        """Keep the mistakes, sorted by place, and word them as `file:line:column: message`."""
        self.path = path
        self.mistakes = sorted(mistakes, key=lambda m: (m.line, m.column))
        super().__init__("\n".join(f"{path}:{m.line}:{m.column}: {m.message}" for m in self.mistakes))


class StoreInUseError(DivideroptError):
    """Another process is writing to this store."""

    exit_code = 3


class StoreError(DivideroptError):
    """The store is damaged, newer than this program, or belongs to another campaign."""

    exit_code = 4


class NoFeasibleDesignError(DivideroptError):
    """The campaign ended and no design was feasible."""

    exit_code = 5


class IncompleteRunsError(DivideroptError):
    """Some runs were given up, since their process died again and again; the others are done."""

    exit_code = 6


class DiskError(DivideroptError):
    """The disk refused: full, read-only, or gone."""

    exit_code = 74
