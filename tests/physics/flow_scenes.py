"""Scenes of flow for tests, whose exact velocities are known."""

HEAD = 'format = "restshape-scene"\nversion = 1\napp = "flow"\n'
SQUARE = """
[shape]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = [1, 0], c = [1, 1], d = [0, 1] }
[shape.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
"""
WINDOW = "[shape.holes.window]\ncircle = { center = [0.4, 0.5], radius = 0.15 }\n"
STEADY, SLOW = "[effects]\nflow = { steady = true }\nconvection = {}\n", "[effects]\nflow = { steady = true }\n"


def in_time(dt: float = 0.05, scheme: str = "bdf2", steps: int = 1, convection: bool = True) -> str:
    """The [effects] of a flow in time."""
    flow = f'[effects]\nflow = {{ time_step = {dt!r}, steps = {steps}, scheme = "{scheme}" }}\n'
    return flow + ("convection = {}\n" if convection else "")


def everywhere(velocity: str, rest: str, mu: float = 0.05, tolerance: float = 1e-11, size: float = 0.1) -> str:
    """A square with a round hole, the same velocity prescribed on both."""
    return (
        HEAD
        + SQUARE
        + WINDOW
        + f"[fluid]\nrho = 1.2\nmu = {mu!r}\n"
        + f'[boundary.sides]\non = ["outline", "window"]\nvelocity = {velocity}\n'
        + rest
        + f"[solve]\ntolerance = {tolerance!r}\n[mesh]\nsize = {size!r}\n"
    )


CHANNEL = (
    HEAD
    + """
[shape]
outline = ["bottom", "outlet", "top", "inlet"]
vertices = { a = [0, 0], b = [3, 0], c = [3, 1], d = [0, 1] }
[shape.edges]
bottom = { line = ["a", "b"] }
outlet = { line = ["b", "c"] }
top = { line = ["c", "d"] }
inlet = { line = ["d", "a"] }
[fluid]
rho = 1.5
mu = 0.1
[boundary.inlet]
on = "inlet"
velocity = ["4*y*(1 - y)", 0]
[boundary.outlet]
on = "outlet"
outflow = true
"""
)
"""A channel without a body; the flow in it is that of Poiseuille."""
CYLINDER = CHANNEL.replace("[fluid]", "[shape.holes.body]\ncircle = { center = [1, 0.5], radius = 0.15 }\n[fluid]")
"""With a round body in it."""
