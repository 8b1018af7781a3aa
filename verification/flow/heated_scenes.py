"""Scenes of heat in fluids, whose numbers are known."""

from restshape_studies.stability.scenery import block, head

HEAD = head("thermal")
SQUARE = block()
STEADY = "[effects]\nflow = { steady = true }\nconvection = {}\nheat = {}\n"
BUOYANT = 'buoyancy = {}\ngravity = { g = [0, "-1 m/s^2"] }\n'

CAVITY = (
    f"{HEAD}[parameters]\nRa = 1e4\nPr = 0.71\n{SQUARE}"
    '[fluid]\nrho = 1\nmu = "Pr"\ndiffusivity = 1\nexpansion = "Ra*Pr"\nreference = "300 K"\n'
    '[boundary.hot]\non = "left"\nwall = true\ntemperature = "300.5 K"\n'
    '[boundary.cold]\non = "right"\nwall = true\ntemperature = "299.5 K"\n'
    '[quantities]\nhot = { nusselt = { length = 1, difference = "1 K" }, at = "left" }\n'
    'cold = { nusselt = { length = 1, difference = "-1 K" }, at = "right" }\n'
    'mean = { temperature = true, at = "all" }\n'
)
"""A square vessel that is heated on the left and cooled on the right; numbers are those of Rayleigh and Prandtl."""


def in_time(time_step: float = 0.05, scheme: str = "bdf2", steps: int = 1, heat: str = "") -> str:
    """The [effects] of a flow in time with heat, whose keys may be given."""
    flow = f'[effects]\nflow = {{ time_step = {time_step!r}, steps = {steps}, scheme = "{scheme}" }}\n'
    return flow + f"convection = {{}}\nheat = {{ {heat} }}\n"


def warm_everywhere(velocity: str, temperature: str, effects: str, tolerance: float = 1e-11, size: float = 0.1) -> str:
    """A square with a round window in it, the same velocity and temperature prescribed on both."""
    window = "[shape.holes.window]\ncircle = { center = [0.4, 0.5], radius = 0.15 }\n"
    return (
        f"{HEAD}{SQUARE}{window}[fluid]\nrho = 1.2\nmu = 0.05\nconductivity = 0.1\nheat_capacity = 1.5\n"
        f'[boundary.sides]\non = ["outline", "window"]\nvelocity = {velocity}\ntemperature = {temperature}\n'
        f"{effects}[solve]\ntolerance = {tolerance!r}\n[mesh]\nsize = {size!r}\n"
    )
