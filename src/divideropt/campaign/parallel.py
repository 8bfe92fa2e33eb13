"""Section `parallel` of a campaign: how the work is spread over processes and machines."""

import re
from typing import Annotated, Self

from pydantic import Field, PlainValidator, WithJsonSchema, model_validator

from divideropt.campaign.fields import OneOf
from divideropt.campaign.sections import Section, show

MOST_WORKERS = 256
"""Beyond it a number of workers is a slip of the finger."""

_BACKENDS = {
    "loky": "worker processes",
    "sequential": "one run after the other, in this process",
    "dask": "the workers of a Dask cluster",
}
_ADDRESS = re.compile(r"(tcp|tls)://[A-Za-z0-9._\[\]:-]{1,253}:[0-9]{1,5}", re.ASCII)


def _address(value: object) -> str:
    if not isinstance(value, str) or not _ADDRESS.fullmatch(value):
        raise ValueError(
            f"{show(value)} is not the address of a scheduler; write tcp://host:port, or tls://host:port"
        )
    return value


class ParallelConfig(Section):
    """How the work is spread."""

    workers: Annotated[int, Field(strict=True, ge=1, le=MOST_WORKERS)] = 2
    """Processes at a time; `dask`: as many as the cluster has."""
    backend: Annotated[str, OneOf("backend", _BACKENDS)] = "loky"
    """`loky`: worker processes; `sequential`: none; `dask`: those of a cluster, see docs/how-to/cluster.md."""
    scheduler: (
        Annotated[
            str, PlainValidator(_address), WithJsonSchema({"type": "string", "pattern": f"^{_ADDRESS.pattern}$"})
        ]
        | None
    ) = None
    """`dask`: the address of the cluster's scheduler, tcp://host:port."""

    @model_validator(mode="after")
    def _scheduler_with_dask(self) -> Self:
        if self.backend == "dask" and self.scheduler is None:
            raise ValueError("backend dask needs its scheduler's address; add scheduler: tcp://host:port")
        if self.backend != "dask" and self.scheduler is not None:
            raise ValueError(f"a scheduler is for backend dask, not {self.backend}; delete it, or change the backend")
        return self
