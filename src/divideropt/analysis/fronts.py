"""Fronts: the non-dominated among designs, and the front of several runs together."""

from collections.abc import Sequence

import moocore
import numpy as np
import pyarrow as pa

from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.store import TableSchema


def combined_front(fronts: Sequence[pa.Table], problem: Problem, schema: TableSchema) -> pa.Table:
    """Merge the fronts of several runs, given in the order of their names, into that of all together."""
    together = pa.concat_tables(fronts)
    told = problem.tell(schema.evaluations(together))
    return together.take(pa.array(np.flatnonzero(nondominated(told.F))))


def nondominated(F: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Mark the non-dominated rows of F, shape (n, k), the first of equals; minimisation."""
    if len(F) == 0:
        return np.zeros(0, dtype=bool)
    return np.asarray(moocore.is_nondominated(F, keep_weakly=False))
