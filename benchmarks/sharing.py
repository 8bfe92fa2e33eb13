"""What two cores give: threads that share a batch, beside two processes that have nothing in common."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider import Divider

SHARES = 2
"""Threads, or processes."""

WARM_UP = 32
"""Designs that each process simulates first, so that it has loaded its compiled functions."""

DELAY = 5e-3
"""How long after it is told [s] every process begins, at the same moment."""


@dataclass(frozen=True)
class Sharing:
    """Costs of one batch [s], the least of many rounds.

    Attributes:
        count: Designs.
        one: On one thread.
        threads: On two threads of one process.
        processes: In two processes, half the batch each.
        one_works: Processor time on one thread; it counts where something else keeps the cores busy.
        threads_work: The same of both threads.
    """

    count: int
    one: float
    threads: float
    processes: float
    one_works: float
    threads_work: float


def share(model: Divider, designs: FloatArray, rounds: Sequence[tuple[int, int]]) -> list[Sharing]:
    """Time batches, each kind in turn, so that what else the machine does hits all of them.

    Args:
        model: The valve, on one thread.
        designs: What batches are filled with, again and again, shape (n, d).
        rounds: Sizes of batches, and how often each is timed.
    """
    threaded = replace(model, threads=SHARES)
    context = get_context("spawn")
    pipes = [context.Pipe() for _ in range(SHARES)]
    workers = [context.Process(target=_work, args=(inner, model, designs), daemon=True) for _, inner in pipes]
    for worker in workers:
        worker.start()
    outer = [end for end, _ in pipes]
    _together(outer, WARM_UP)
    found = []
    for count, times in rounds:
        batch = _filled(designs, count)
        costs = [
            (
                *_both_clocks(partial(model.evaluate, batch)),
                *_both_clocks(partial(threaded.evaluate, batch)),
                _together(outer, count // SHARES),
            )
            for _ in range(times)
        ]
        one, one_works, threads, threads_work, processes = np.min(costs, axis=0).tolist()
        found.append(Sharing(count, one, threads, processes, one_works, threads_work))
    for end, worker in zip(outer, workers, strict=True):
        end.send(None)
        worker.join()
    return found


def _both_clocks(call: Callable[[], Any]) -> tuple[float, float]:
    """Return how long a call takes, and the processor time of all threads [s]."""
    begin, works = time.perf_counter(), time.process_time()
    call()
    return time.perf_counter() - begin, time.process_time() - works


def _together(ends: Sequence["Connection[Any, Any]"], count: int) -> float:
    """Let every process simulate so many designs at the same time; return how long it takes them all [s]."""
    begin = time.perf_counter() + DELAY
    for end in ends:
        end.send((begin, count))
    return float(max(end.recv() for end in ends) - begin)


def _work(end: "Connection[Any, Any]", model: Divider, designs: FloatArray) -> None:
    """Simulate whenever told to, and say when it was done; the clock is the machine's."""
    while (told := end.recv()) is not None:
        begin, count = told
        batch = _filled(designs, count)
        while time.perf_counter() < begin:
            pass
        model.evaluate(batch)
        end.send(time.perf_counter())


def _filled(designs: FloatArray, count: int) -> FloatArray:
    return designs[np.arange(count) % len(designs)]
