"""What the kernels' vectors hold. In a file of its own, since reading a campaign needs it and no compiler."""

STATES = ("Ps", "Pa1", "Pa2", "Pb1", "Pb2", "xdot", "x", "PL1", "PL2")
"""Names of the states, in the order of a state vector."""

N_STATES = len(STATES)

FRICTION_VELOCITY = 1e-6
"""ẋ_tan of (2.17) [m/s]: Coulomb friction is Fc tanh(ẋ/ẋ_tan)."""
