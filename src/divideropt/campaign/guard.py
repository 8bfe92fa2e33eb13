"""Simulates in a child process, which may die or hang: only the design that made it so is blamed."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from multiprocessing import Pipe

import numpy as np

from divideropt.campaign.execute import StoppedError
from divideropt.errors import DivideroptError
from divideropt.models import Outcome, Verdict
from divideropt.models.base import FloatArray
from divideropt.problem import Evaluations

DEATHS = 2
"""So many child processes a design may cost before it is `crashed`: one may have died of something else."""

_LOOK_SECONDS = 0.2
"""How often a child that does not answer is looked at [s]."""


class GuardError(DivideroptError):
    """The child process cannot be started; the exit code is that of a bug, since its parent reads that campaign."""


class Guard:
    """Simulates the designs of one campaign in a child process of this one."""

    def __init__(
        self, text: str, quantities: int, deadline: float | None = None, *, suspicious: bool = False
    ) -> None:
        """Prepare; the child is started when it is first needed.

        Args:
            text: The campaign as resolved.
            quantities: How many the model has.
            deadline: How long a design may take [s]; None for ever. Where given, each design is a call of its own.
            suspicious: Whether the first batch is thought to kill its process: its designs are simulated singly.
        """
        self._text, self._quantities, self._deadline = text, quantities, deadline
        self._suspicious = suspicious
        self._child: _Child | None = None
        self._stopped = False

    def simulate(self, designs: FloatArray) -> Evaluations:
        """Simulate a batch: whole, or one design at a time if the child dies of it.

        Args:
            designs: Shape (n, d), in the variables' units.

        Returns:
            What came out. A design beyond the deadline is `timed_out`, one that killed two children `crashed`.

        Raises:
            StoppedError: `stop` was called.
            GuardError: The child cannot be started.
        """
        if self._deadline is None and not self._suspicious:
            with suppress(_DiedError):
                return self._ask(designs)
        self._suspicious = False
        return Evaluations.together([self._single(design[None]) for design in designs])

    def stop(self) -> None:
        """Drop what is being simulated; called from another thread."""
        self._stopped = True
        if self._child is not None:
            self._child.kill()

    def close(self) -> None:
        """End the child."""
        if self._child is not None:
            self._child.kill()
            self._child = None

    def _single(self, design: FloatArray) -> Evaluations:
        how = ""
        for _ in range(DEATHS):
            try:
                return self._ask(design)
            except _LateError:
                text = f"no result within the deadline of {self._deadline:g} s; its process was ended"
                return self._failed(design, Verdict(Outcome.TIMED_OUT, text))
            except _DiedError as died:
                how = str(died)
        return self._failed(design, Verdict(Outcome.CRASHED, f"it killed its process, twice: {how}"))

    def _failed(self, design: FloatArray, verdict: Verdict) -> Evaluations:
        return Evaluations(design, np.full((1, self._quantities), np.nan), [verdict])

    def _ask(self, designs: FloatArray) -> Evaluations:
        if self._stopped:
            raise StoppedError
        if self._child is None:
            self._child = _started(self._text)
        try:
            return self._child.simulate(designs, self._deadline)
        except (_DiedError, _LateError):
            self.close()
            if self._stopped:
                raise StoppedError from None
            raise


class _DiedError(Exception):
    """The child died; how."""


class _LateError(Exception):
    """The child did not answer in time."""


def _started(text: str) -> "_Child":
    try:
        return _Child(text)
    except _DiedError as died:
        raise GuardError(
            f"the process that is to simulate the model cannot be started ({died}); what it said is above. What was "
            "logged is intact"
        ) from None


class _Child:
    """A process that simulates; it has a process group of its own, so that what the model started ends with it."""

    def __init__(self, text: str) -> None:
        self._link, theirs = Pipe()
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", "divideropt.campaign.child", str(theirs.fileno())],
                stdin=subprocess.DEVNULL,
                pass_fds=[theirs.fileno()],
                process_group=0,
                env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
            )
        self._exchange(text, None)

    def simulate(self, designs: FloatArray, deadline: float | None) -> Evaluations:
        found: Evaluations = self._exchange(designs, deadline)
        return found

    def kill(self) -> None:
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()

    def _exchange(self, what: object, within: float | None) -> Evaluations:
        try:
            self._link.send(what)
            end = None if within is None else time.monotonic() + within
            while not self._link.poll(_LOOK_SECONDS if end is None else _until(end)):
                if self._process.poll() is not None:
                    raise EOFError
                if end is not None and time.monotonic() >= end:
                    raise _LateError
            answer: Evaluations = self._link.recv()
        except (EOFError, OSError):
            raise _DiedError(self._ended()) from None
        return answer

    def _ended(self) -> str:
        """Say how the process ended, which has closed its end of the pipe."""
        try:
            return _how(self._process.wait(timeout=1.0))
        except subprocess.TimeoutExpired:
            self.kill()
            return "it closed its pipe"


def _until(end: float) -> float:
    return min(_LOOK_SECONDS, max(0.0, end - time.monotonic()))


def _how(code: int) -> str:
    """Say how a process ended, from its exit code."""
    if code >= 0:
        return f"it left with exit code {code}"
    try:
        return f"signal {-code}, {signal.Signals(-code).name}"
    except ValueError:
        return f"signal {-code}"
