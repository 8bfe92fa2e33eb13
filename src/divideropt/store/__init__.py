"""The store on disk: evaluation logs, fronts, the campaign as resolved."""

from divideropt.store.log import RunLog
from divideropt.store.schema import Role, TableSchema
from divideropt.store.store import Store

__all__ = ["Role", "RunLog", "Store", "TableSchema"]
