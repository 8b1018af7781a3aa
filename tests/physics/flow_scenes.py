"""Scenes of flow for tests, whose exact velocities are known."""

from restshape_verification.flow.scenes import channel, disc

CHANNEL = channel(3, 1, "rho = 1.5\nmu = 0.1\n")
"""A channel without a body; the flow in it is that of Poiseuille."""
CYLINDER = channel(3, 1, "rho = 1.5\nmu = 0.1\n", holes=disc("body", (1, 0.5), 0.15))
"""With a round body in it."""
