"""Scenes of published flows, whose numbers are known."""

HEAD = 'format = "restshape-scene"\nversion = 1\napp = "flow"\n'
STEADY = "[effects]\nflow = { steady = true }\nconvection = {}\n"


def in_time(time_step: float, scheme: str = "bdf2") -> str:
    """The [effects] of a flow in time."""
    return f'[effects]\nflow = {{ time_step = {time_step!r}, scheme = "{scheme}" }}\nconvection = {{}}\n'


CAVITY = (
    HEAD
    + """
[parameters]
Re = 100
[shape]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = [1, 0], c = [1, 1], d = [0, 1] }
[shape.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[fluid]
rho = 1
mu = "1/Re"
[boundary.lid]
on = "top"
velocity = [1, 0]
"""
)
"""A square whose lid moves at 1 m/s; its corners stand still."""

CHANNEL = (
    HEAD
    + """
[parameters]
U = 0.3
[shape]
outline = ["bottom", "outlet", "top", "inlet"]
vertices = { a = [0, 0], b = [2.2, 0], c = [2.2, 0.41], d = [0, 0.41] }
holes = { cylinder = { circle = { center = [0.2, 0.2], radius = 0.05 } } }
[shape.edges]
bottom = { line = ["a", "b"] }
outlet = { line = ["b", "c"] }
top = { line = ["c", "d"] }
inlet = { line = ["d", "a"] }
[fluid]
rho = 1
mu = 1e-3
[boundary.inlet]
on = "inlet"
velocity = ["4*U*y*(0.41 - y)/0.41^2", 0]
[boundary.outlet]
on = "outlet"
outflow = true
"""
)
"""A cylinder in a channel, of the priority research programme of the DFG: velocity U in the middle of the inlet."""

ZONE = "[shape.regions.zone]\npolygon = [[0.05, 0.05], [0.6, 0.05], [0.6, 0.36], [0.05, 0.36]]\n"
"""Around the cylinder and behind it, for a finer mesh there."""


def forces(speed: float) -> str:
    """The [quantities] of the cylinder, whose coefficients count on a mean speed [m/s]."""
    of = f'{{ speed = {speed!r}, length = 0.1 }}, at = "cylinder" }}\n'
    return (
        f"[quantities]\ndrag = {{ drag_coefficient = {of}lift = {{ lift_coefficient = {of}"
        'drop = { pressure_drop = { from = "cylinder.v3", to = "cylinder.v1" } }\n'
        'entering = { flux = true, at = "inlet" }\nleaving = { flux = true, at = "outlet" }\n'
    )


def kovasznay(decay: float, mu: float) -> str:
    """Kovasznay's flow in a square, by its velocity on all sides."""
    shape = CAVITY[: CAVITY.index("[fluid]")].replace("Re = 100", f"l = {decay!r}")
    return (
        shape
        + f"[fluid]\nrho = 1\nmu = {mu!r}\n"
        + '[boundary.sides]\non = "outline"\nvelocity = ["1 - exp(l*x)*cos(2*pi*y)", "l/(2*pi)*exp(l*x)*sin(2*pi*y)"]\n'
        + STEADY
    )


def dragged(velocity: str, effects: str) -> str:
    """A square with a round window in it, the same velocity prescribed on both."""
    shape = CAVITY[: CAVITY.index("[fluid]")].replace("[parameters]\nRe = 100\n", "")
    return (
        shape
        + "[shape.holes.window]\ncircle = { center = [0.4, 0.5], radius = 0.15 }\n[fluid]\nrho = 1.2\nmu = 0.05\n"
        + f'[boundary.sides]\non = ["outline", "window"]\nvelocity = {velocity}\n'
        + effects
        + "[solve]\ntolerance = 1e-11\n[mesh]\nsize = 0.1\n"
    )
