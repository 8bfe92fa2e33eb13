"""Toys that die, hang and break down: on some designs each time, or once."""

import ctypes
import os
import signal
import sys
import time
from pathlib import Path

import numpy as np

from toy_model import Toy


class Rough(Toy):
    """A toy that fares badly with designs whose x3 lies from `begin` to `end`.

    Args:
        way: What it does with them: an entry of `_WAYS`.
        begin: Where they begin.
        end: Where they end.
        once: A file; where it is given, the model fares badly only as long as it is not there, and makes it.
        pause: How long every design takes [s].
        after: So many designs the process simulates before it fares badly with any.
    """

    def __init__(self, way="kill", begin=0.9, end=0.95, once="", pause=0.0, after=0):
        super().__init__()
        self.way, self.begin, self.end, self.once, self.pause = way, begin, end, once, pause
        self.after, self.seen = after, 0

    def evaluate(self, designs):
        time.sleep(self.pause * len(designs))
        bad = (designs[:, 2] >= self.begin) & (designs[:, 2] <= self.end)
        self.seen += len(designs)
        if np.any(bad) and self.seen > self.after and self._willing():
            _WAYS[self.way]()
        return super().evaluate(designs)

    def _willing(self):
        if not self.once:
            return True
        try:
            Path(self.once).touch(exist_ok=False)
        except FileExistsError:
            return False
        return True


def _kill():
    os.kill(os.getpid(), signal.SIGKILL)


def _fault():
    os.kill(os.getpid(), signal.SIGSEGV)


def _raise():
    raise ArithmeticError("no root between the brackets")


def _hang():
    time.sleep(3600)


def _hang_compiled():
    """Hang in C without letting another thread run, as an extension does that keeps the interpreter's lock."""
    ctypes.PyDLL(None).sleep(3600)


_WAYS = {
    "kill": _kill,
    "fault": _fault,
    "raise": _raise,
    "leave": lambda: sys.exit(7),
    "vanish": lambda: os._exit(7),
    "hang": _hang,
    "hang_compiled": _hang_compiled,
}
