"""The tables of parameters and quantities: nobody copies them by hand."""

from divideropt.models.base import Parameter, Quantity
from divideropt.models.divider import PARAMETER_SETS, PARAMETERS, QUANTITIES
from modelpages.tables import table


def parameters_table() -> str:
    """Every parameter of the model."""
    header = ["name", "symbol", "unit", "meaning", "accepts", "`thesis_base`", "from"]
    return table(header, [_parameter(p) for p in PARAMETERS.values()])


def quantities_table() -> str:
    """Every quantity of the model."""
    header = ["name", "symbol or equation", "unit", "meaning", "sign"]
    return table(header, [_quantity(q) for q in QUANTITIES.values()])


def sets_table() -> str:
    """What the other parameter sets change."""
    sets = {name: changes for name, changes in PARAMETER_SETS.items() if changes}
    names = [name for name in PARAMETERS if any(name in changes for changes in sets.values())]
    rows = [[f"`{n}`", *(f"{changes.get(n, PARAMETERS[n].default):g}" for changes in sets.values())] for n in names]
    return table(["name", *(f"`{name}`" for name in sets)], rows, numbers_from=1)


def _parameter(p: Parameter) -> list[str]:
    return [f"`{p.name}`", p.symbol, _unit(p.unit), p.description, str(p.domain), f"{p.default:.6g}", p.source]


def _quantity(q: Quantity) -> list[str]:
    symbol = q.symbol.replace("|", "\\|") or "–"
    return [f"`{q.name}`", symbol, _unit(q.unit), q.description, "signed" if q.signed else ""]


def _unit(unit: str) -> str:
    return unit.replace("^3", "³").replace("^2", "²") or "1"
