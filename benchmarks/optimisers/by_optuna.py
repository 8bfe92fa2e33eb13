"""Optuna's NSGA-II and TPE, with its constraints."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import optuna

from .interview import Interview


def nsga2(interview: Interview, seed: int) -> None:
    """Optuna's defaults: population 50; uniform crossover 0.9."""
    _optimise(interview, optuna.samplers.NSGAIISampler(seed=seed))


def tpe(interview: Interview, seed: int) -> None:
    """Optuna's defaults: 10 random trials first."""
    _optimise(interview, optuna.samplers.TPESampler(seed=seed))


def _optimise(interview: Interview, sampler: Any) -> None:
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    names = interview.problem.space.names
    bounds = list(zip(names, interview.lower.tolist(), interview.upper.tolist(), strict=True))

    def objective(trial: Any) -> Sequence[float]:
        told = interview(np.array([[trial.suggest_float(*bound) for bound in bounds]]))
        for i, value in enumerate(told.G[0].tolist()):
            trial.set_constraint(f"g{i}", value)
        return list(told.F[0].tolist())

    study = optuna.create_study(directions=["minimize"] * interview.objectives, sampler=sampler)
    study.optimize(objective, n_trials=None)
