"""The `sensitivity` section: what a study varies, and how it samples that."""

import dataclasses
from collections.abc import Callable, Mapping
from typing import Annotated, Any, cast

from pydantic import Field, PlainSerializer, PlainValidator, TypeAdapter, ValidationError, WithJsonSchema

from divideropt.campaign import schemas
from divideropt.campaign.fields import by_name
from divideropt.campaign.plans import LARGEST_SEED
from divideropt.campaign.ranges import read_range
from divideropt.campaign.sections import Section, mistake, relay, show, together, unknown
from divideropt.strategies import Morris, OneAtATime, Sobol, Strategy


def _read(strategy: type[Strategy]) -> Callable[[object], Any]:
    """Make a validator of a sampling's options."""
    known = [option.name for option in dataclasses.fields(cast(Any, strategy))]

    def validate(raw: object) -> Any:
        if isinstance(raw, strategy):
            return raw
        if not isinstance(raw, Mapping):
            raise ValueError(f"{show(raw)} is not a mapping; write options in braces, such as {{{known[0]}: 64}}")
        found = [
            mistake((str(key),), unknown("option", str(key), known), at_key=True) for key in raw if key not in known
        ]
        try:
            made = cast(Any, strategy)(**{key: raw[key] for key in known if key in raw})
        except ValidationError as error:
            found += relay(error)
        if found:
            raise together(found)
        return made

    return validate


_AS_WRITTEN = PlainSerializer(lambda options: dataclasses.asdict(options), when_used="json")  # noqa: PLW0108 (typed)


class SensitivityConfig(Section):
    """What `divideropt sensitivity` varies, and how it samples that."""

    parameters: Annotated[
        Mapping[str, tuple[float, float]],
        PlainValidator(by_name("parameters", read_range)),
        WithJsonSchema(schemas.study()),
    ] = Field(default_factory=dict)
    """Lower and upper end of each parameter studied. Where none is given, `morris` and `sobol` take the campaign's
    variables, and `oat` the ten of section 3.4 of the thesis, or the variables of a model of one's own."""
    oat: Annotated[
        OneAtATime,
        PlainValidator(_read(OneAtATime)),
        _AS_WRITTEN,
        WithJsonSchema(TypeAdapter(OneAtATime).json_schema()),
    ] = OneAtATime()
    """One parameter at a time, the others where the campaign has them."""
    morris: Annotated[
        Morris, PlainValidator(_read(Morris)), _AS_WRITTEN, WithJsonSchema(TypeAdapter(Morris).json_schema())
    ] = Morris()
    """Elementary effects along trajectories (Morris 1991)."""
    sobol: Annotated[
        Sobol, PlainValidator(_read(Sobol)), _AS_WRITTEN, WithJsonSchema(TypeAdapter(Sobol).json_schema())
    ] = Sobol()
    """Shares of the variance (Saltelli 2002)."""
    seed: Annotated[int, Field(strict=True, ge=0, le=LARGEST_SEED)] = 1
    """Seeds the samples of `morris` and `sobol`."""
