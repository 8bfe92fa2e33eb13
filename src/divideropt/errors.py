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
        """Keep the mistakes, sorted by place, and word them as `file:line:column: message`, each on one line."""
        self.path = path
        self.mistakes = sorted(mistakes, key=lambda m: (m.line, m.column))
        super().__init__("\n".join(f"{path}:{m.line}:{m.column}: {printable(m.message)}" for m in self.mistakes))


def printable(text: str) -> str:
    """Escape what is no printable character: a file's own words shall not break lines or steer a terminal."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


LONGEST_WORDS = 200
"""Characters of what a file, a library or a model has to say, within a sentence of ours."""


def shortened(text: str) -> str:
    """Cut what somebody else has to say to what fits into a sentence."""
    return text if len(text) <= LONGEST_WORDS else f"{text[:LONGEST_WORDS]}…"


def words_of(error: BaseException) -> str:
    """Word an exception of somebody else's code in one line: its class, and what it says if it says anything."""
    try:
        text = " ".join(str(error).split())
    except Exception:  # an exception's own `__str__` may raise
        text = ""
    return shortened(": ".join(filter(None, [type(error).__name__, text])))


class StoreInUseError(DivideroptError):
    """Another process is writing to this store."""

    exit_code = 3


class StoreError(DivideroptError):
    """The store is damaged, newer than this program, or belongs to another campaign."""

    exit_code = 4


class DamagedFileError(StoreError):
    """A file of the store is not as it was written; one that follows from the logs can be made again."""


class BatchDiffersError(StoreError):
    """A strategy asks for another batch than the one in its log.

    Attributes:
        run: The run.
        batch: Which batch, from 0; so many before it are the same.
    """

    def __init__(self, run: str, batch: int) -> None:
        """Keep both; as arguments, so that it passes from one process to another."""
        super().__init__(run, batch)
        self.run, self.batch = run, batch

    def __str__(self) -> str:
        """Say what it is, and what to do."""
        return (
            f"run {self.run}: batch {self.batch} of the log is not the one the strategy asks for, which should be "
            "the same to the bit. Another version of a library, or another processor, computes differently; go on "
            f"there, or here as a new run, which begins with the {self.batch} batches before it "
            "(`divideropt run --branch`), or start anew (--fresh)."
        )


class NoFeasibleDesignError(DivideroptError):
    """The campaign ended and no design was feasible."""

    exit_code = 5


class IncompleteRunsError(DivideroptError):
    """Some runs were given up, since their process died again and again; the others are done."""

    exit_code = 6


class DiskError(DivideroptError):
    """The disk refused: full, read-only, or gone."""

    exit_code = 74
