"""Multiobjective optimisation of simulated hydraulic components."""
