"""Stiff solvers, one call for all of them."""

from divideropt.ode.base import Event, SolverSettings, SolverStatus, Trajectory
from divideropt.ode.integrate import METHODS, ROSENBROCK, integrate

__all__ = ["METHODS", "ROSENBROCK", "Event", "SolverSettings", "SolverStatus", "Trajectory", "integrate"]
