"""What a store holds, read as a user reads it, and whether two stores hold the same."""

from pathlib import Path

import pandas as pd


def logs(folder: Path) -> dict[str, pd.DataFrame]:
    """Each run's log by the run's name."""
    return {p.name: pd.read_parquet(p) for p in sorted((folder / "evaluations").iterdir())}


def tables(folder: Path) -> dict[str, pd.DataFrame]:
    """Every front and every log."""
    fronts = {f"front {p.stem}": pd.read_parquet(p) for p in sorted((folder / "fronts").glob("*.parquet"))}
    return fronts | {f"log {name}": table for name, table in logs(folder).items()}


def assert_same(first: Path, second: Path) -> None:
    """Fronts and logs are the same, column by column and byte by byte."""
    one, other = tables(first), tables(second)
    assert list(one) == list(other)
    for name, table in one.items():
        assert list(table.columns) == list(other[name].columns)
        for column in table.columns:
            mine, its = table[column].to_numpy(), other[name][column].to_numpy()
            same = mine.tolist() == its.tolist() if mine.dtype == object else mine.tobytes() == its.tobytes()
            assert same, (name, column)
