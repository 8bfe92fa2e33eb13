"""A campaign's uncertain parameters in words, for the setting of a report."""

from collections.abc import Iterator

from divideropt.campaign.config import Campaign
from divideropt.models import Parameter
from divideropt.models.distributions import Distribution, LogUniform, Normal, Triangular
from divideropt.models.uncertain import Source
from divideropt.report.display import axis_of, number


def uncertainty_words(campaign: Campaign) -> Iterator[tuple[str, str]]:
    """Word the uncertainty as a pair of a heading and a sentence; nothing where everything is certain."""
    asked = campaign.uncertainty
    if asked is None:
        return
    parameters = campaign.model.tables().parameters or {}
    sources = "; ".join(_source_words(parameters[name], source) for name, source in asked.parameters.items())
    yield (
        "Uncertainty",
        f"every design also in the same {asked.samples} samples (seed {asked.seed}) of {sources}. Quantities without "
        "a statistic are those of the design as it is",
    )


def _source_words(parameter: Parameter, source: Source) -> str:
    name = parameter.name.replace("_", " ")
    drawn = source.distribution
    if source.oil is not None:
        cold, warm = (
            f"{axis_of(parameter, [v]).bound(v)} at {t:g} °C" for t, v in (source.oil.cold, source.oil.warm)
        )
        law = f"{name} by Walther's law through {cold} and {warm}"
        return f"{law}, temperature {_distribution_words(drawn, [f'{v:g} °C' for v in _values(drawn)])}"
    if source.acting == "factor":
        return f"{name} times a factor {_distribution_words(drawn, [number(v) for v in _values(drawn)])}"
    axis = axis_of(parameter, _values(drawn))
    words = _distribution_words(drawn, [axis.bound(v) for v in _values(drawn)])
    return f"{name} plus an offset {words}" if source.acting == "offset" else f"{name} {words}"


def _values(drawn: Distribution) -> list[float]:
    """The numbers that make a distribution, its ends first."""
    ends = [drawn.lower, drawn.upper]
    if isinstance(drawn, Triangular):
        return [*ends, drawn.mode]
    return [*ends, drawn.mean, drawn.sd] if isinstance(drawn, Normal) else ends


def _distribution_words(drawn: Distribution, values: list[str]) -> str:
    low, high, *others = values
    if isinstance(drawn, Triangular):
        return f"triangular from {low} to {high}, mostly {others[0]}"
    if isinstance(drawn, Normal):
        return f"normal about {others[0]} with a standard deviation of {others[1]}, cut off at {low} and {high}"
    return f"{'log-uniform' if isinstance(drawn, LogUniform) else 'uniform'} from {low} to {high}"
