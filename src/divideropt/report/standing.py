"""Where a store stands: the front of what is logged so far, and sentences on its state."""

from collections.abc import Mapping, Sequence

import pyarrow as pa

from divideropt.analysis import Summary, combined_front
from divideropt.campaign.mishaps import Mishaps
from divideropt.errors import DamagedFileError
from divideropt.problem import Problem
from divideropt.report.runs import RunFacts
from divideropt.store import Store, TableSchema


def front_of(
    store: Store, logs: Mapping[str, Summary], problem: Problem, schema: TableSchema
) -> tuple[pa.Table, tuple[str, ...]]:
    """The combined front of what is logged, and what to say of the stored one if that is another.

    The stored one is written when a campaign ends. While an extended one runs, it is older than the logs, and
    would contradict every count beside it.
    """
    table = combined_front([logs[name].front for name in sorted(logs)], problem, schema)
    try:
        stored = store.read_front("combined", schema)
    except DamagedFileError:
        return table, (
            "fronts/combined.parquet is damaged: the front below is that of all evaluations, and the next "
            "`divideropt run` writes the file again.",
        )
    if stored is None:
        return table, ("The campaign has not ended: the front below is that of the evaluations logged so far.",)
    if stored["design_id"].to_pylist() != table["design_id"].to_pylist():
        return table, (
            "fronts/combined.parquet is older than the logs: the front below is that of all evaluations so far.",
        )
    return table, ()


def state_of(runs: Sequence[RunFacts], store: Store) -> tuple[str, ...]:
    """Say which runs have not begun, which a clock had a hand in, and which were given up."""
    waiting = [run.name for run in runs if run.evaluations == 0]
    clocked = [run.name for run in runs if not run.repeatable]
    notes = []
    if waiting:
        notes.append(f"Not begun yet: {', '.join(waiting)}.")
    if clocked:
        notes.append(f"Not repeatable from scratch, since a simulation timed out or crashed: {', '.join(clocked)}.")
    failures = {run.name: Mishaps(store.status_folder, run.name).failure for run in runs}
    notes += [f"Incomplete, given up: {name}: {reason}." for name, reason in failures.items() if reason]
    return tuple(notes)
