"""The drape as Newton's example of hanging cloth has it: ten steps to a sixtieth of a second, ten passes in each.

Source: `newton.examples`, `cloth_hanging` with `--solver vbd`. Nothing is damped, as the fabric has no viscosity.
"""

from falling import VERSION, Falling

PROBLEMS = {"drape": Falling}

__all__ = ["PROBLEMS", "VERSION"]
