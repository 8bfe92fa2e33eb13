"""The store on disk: evaluation logs, fronts and their verification, the campaign as resolved."""

from divideropt.store.endings import EndingRecord
from divideropt.store.log import RunLog
from divideropt.store.parts import Parts
from divideropt.store.schema import Role, TableSchema
from divideropt.store.store import Store

__all__ = ["EndingRecord", "Parts", "Role", "RunLog", "Store", "TableSchema"]
