"""A process that shall not outlive its parent, whatever the parent dies of."""

import ctypes
import os
import signal
import sys
import threading
import time
from functools import cache

WATCH_SECONDS = 0.5
"""How often a process looks whether its parent still lives."""

_PR_SET_PDEATHSIG = 1


@cache
def end_with_parent(started_by: int | None = None) -> None:
    """End this process when its parent has ended.

    The kernel sees to it where it can (Linux), since a thread cannot run while compiled code holds the interpreter.
    There, the parent is the thread that started the process.

    Args:
        started_by: The parent, where the process knows: it may have ended already, and this one then ends at once.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    parent = os.getppid() if started_by is None else started_by
    if os.getppid() != parent:
        os._exit(1)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(WATCH_SECONDS)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
