"""The drape as one would tune it to rest: shorter steps, which passes can follow, and kinetic damping.

With longer steps, or fewer passes, the cloth stands at places where forces do not balance: passes take back as much of
the weight's step as they can, and no more. Tried with kinetic damping (the residual at which it stands, by the loop of
`falling.py`): steps of 5 ms and 10 passes 25, 1.7 ms and 30 passes 0.5, 0.8 ms and 10 passes 0.28.
"""

from falling import VERSION, Falling


class Tuned(Falling):
    """A fall in steps of 0.8 ms that is stopped at each peak of its kinetic energy."""

    step = 0.8e-3
    stopped = True


PROBLEMS = {"drape": Tuned}

__all__ = ["PROBLEMS", "VERSION"]
