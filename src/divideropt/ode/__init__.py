"""Stiff solvers, one call for all of them."""

from divideropt.ode.base import SolverSettings, SolverStatus, Trajectory
from divideropt.ode.scipy_solvers import METHODS, Event, integrate

__all__ = ["METHODS", "Event", "SolverSettings", "SolverStatus", "Trajectory", "integrate"]
