"""The figures of section 3.4 over a parameter's range: errors, settling time and source pressure."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from claims.criteria import strong, tail
from claims.judgement import Judgement, Statement
from claims.runs import Runs, Sweep
from modelpages.chart import Line, Panel, draw

from divideropt.models.base import FloatArray
from divideropt.models.divider import Scenario
from thesisfigures.figure import TITLES, Both

AXES: Mapping[str, tuple[str, float, str]] = {
    "spool_radius": ("spool radius r", 1e3, "mm"),
    "groove_width": ("groove width b", 1e3, "mm"),
    "radial_clearance": ("clearance δ", 1e6, "µm"),
    "total_pressure_drop": ("total pressure drop ΔPt", 1e-6, "MPa"),
    "fixed_drop_ratio": ("drop ratio ΔPo/ΔPt", 1.0, ""),
    "centred_opening": ("open fraction, spool centred, FO", 1.0, ""),
    "rim_thickness": ("rim thickness t_rim", 1e3, "mm"),
    "coulomb_friction": ("Coulomb friction Fc", 1.0, "N"),
    "kinematic_viscosity": ("viscosity ν", 1e6, "mm²/s"),
}
"""Name and symbol of each parameter, factor from SI, unit."""

ERRORS: Sequence[tuple[str, str, str]] = (
    ("steady_state_error", "steady (3.6)", "solid"),
    ("dynamic_error_percent", "dynamic (3.12)", "dash"),
    ("total", "total (3.8)", "dot"),
)
"""The curves of an error figure, their labels and dashes."""

STROKES = {"conservative": (0, "solid"), "listing, cold": (1, "dash")}
"""Colour and dash of each variant where they share a panel."""


def draw_errors(parameter: str) -> Callable[[Both], str]:
    """Make what draws steady, dynamic and total error after 0.2 s, in percent of the source flow."""

    def drawn(both: Both) -> str:
        curves = {name: _errors(runs.sweep(parameter)) for name, runs in both.items()}
        extent = _padded([values for found in curves.values() for values in found.values()])
        panels = []
        for name, found in curves.items():
            x = _places(both[name].sweep(parameter), parameter)
            lines = [Line(label, x, found[key], i, dash) for i, (key, label, dash) in enumerate(ERRORS)]
            panels.append(
                Panel(lines, axis_label(parameter), "error after 0.2 s [%]", TITLES[name], _range(x), extent)
            )
        return draw(panels, f"Steady, dynamic and total error after 0.2 s against {AXES[parameter][0]}")

    return drawn


def draw_settling(parameter: str) -> Callable[[Both], str]:
    """Make what draws the settling time."""
    return _one_panel(parameter, "settling_time", 1.0, "settling time ts [s]", "Settling time")


def draw_source_pressure(parameter: str) -> Callable[[Both], str]:
    """Make what draws the source pressure."""
    return _one_panel(parameter, "source_pressure", 1e-6, "source pressure Ps [MPa]", "Steady source pressure")


def left_out(parameter: str) -> Callable[[Both], str]:
    """Make what says which designs are not in the curves."""

    def said(both: Both) -> str:
        parts = [f"{name}{tail(runs.sweep(parameter))}" for name, runs in both.items() if tail(runs.sweep(parameter))]
        return f"Of 100 designs: {'; '.join(parts)}." if parts else "All 100 designs of either curve are `ok`."

    return said


def axis_label(parameter: str) -> str:
    """Return a parameter's name, symbol and unit."""
    name, _, unit = AXES[parameter]
    return f"{name} [{unit}]" if unit else name


def settling_is_strong(parameter: str) -> Statement:
    """Return what a figure's caption claims that says no more than “effect on the settling time”."""

    def judge(runs: Runs) -> Judgement:
        return strong(runs.sweep(parameter), "settling_time", runs.base())

    return Statement("Effect of … on the settling time", "", "Settling time: strong.", judge)


def _one_panel(parameter: str, quantity: str, factor: float, label: str, words: str) -> Callable[[Both], str]:
    def drawn(both: Both) -> str:
        lines = []
        for name, runs in both.items():
            sweep = runs.sweep(parameter)
            curve = np.where(sweep.ok, sweep.results[quantity] * factor, np.nan)
            lines.append(Line(TITLES[name], _places(sweep, parameter), curve, *STROKES[name]))
        top = 1.1 * max(float(np.nanmax(line.y)) for line in lines)  # as the author's axes
        panel = Panel(lines, axis_label(parameter), label, "", _range(lines[0].x), (0.0, top))
        return draw([panel], f"{words} against {AXES[parameter][0]}")

    return drawn


def _errors(sweep: Sweep) -> dict[str, FloatArray]:
    """Return the curves of `ERRORS`, shape (n,), NaN where a design is not ok."""
    flown = Scenario().source_flow * Scenario().accumulation_time
    found = {**sweep.results, "total": 100 * sweep.results["cumulative_error"] / flown}
    return {key: np.where(sweep.ok, found[key], np.nan) for key, _, _ in ERRORS}


def _places(sweep: Sweep, parameter: str) -> FloatArray:
    return sweep.values * AXES[parameter][1]


def _range(x: FloatArray) -> tuple[float, float]:
    return float(x[0]), float(x[-1])


def _padded(arrays: Sequence[FloatArray]) -> tuple[float, float]:
    low = min(0.0, *(float(np.nanmin(values)) for values in arrays))
    high = max(0.0, *(float(np.nanmax(values)) for values in arrays))
    margin = 0.06 * (high - low)
    return low - margin, high + margin
