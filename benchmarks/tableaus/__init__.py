"""Rosenbrock methods that are compared with the one in use, each as `divideropt.ode.rodas5p` has its own.

All are written as Hairer and Wanner have it, Solving Ordinary Differential Equations II, section IV.7. The
coefficients are those of the papers that each names, as SciML's OrdinaryDiffEq.jl has them too; `order.py` holds them
to their orders.
"""
