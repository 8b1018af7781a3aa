"""Scenes of published flows, whose numbers are known."""

from restshape_studies.stability.scenery import block, head

HEAD = head("flow")
STEADY, SLOW = "[effects]\nflow = { steady = true }\nconvection = {}\n", "[effects]\nflow = { steady = true }\n"
SQUARE = block()
"""A square of 1 m x 1 m with the edges bottom, right, top and left."""


def in_time(
    time_step: float = 0.05, scheme: str = "bdf2", steps: int = 1, convection: bool = True, carry: str = "auto"
) -> str:
    """The [effects] of a flow in time."""
    flow = (
        f'[effects]\nflow = {{ time_step = {time_step!r}, steps = {steps}, scheme = "{scheme}", carry = "{carry}" }}\n'
    )
    return flow + ("convection = {}\n" if convection else "")


def channel(length: float, height: float, fluid: str, entering: str = "4*y*(1 - y)", holes: str = "") -> str:
    """A channel whose fluid enters by its edge `inlet` and leaves by `outlet`.

    Args:
        length, height: of the channel, whose other edges are bottom and top [m].
        fluid: lines of [fluid].
        entering: the velocity along x where it enters [m/s].
        holes: tables of what stands in it, and of parameters.
    """
    shape = block(length, height).replace("right", "outlet").replace("left", "inlet")
    return HEAD + shape + holes + through(fluid, entering)


def through(fluid: str, entering: str) -> str:
    """What flows through such a channel; arguments as of `channel`."""
    return (
        f'[fluid]\n{fluid}[boundary.inlet]\non = "inlet"\nvelocity = ["{entering}", 0]\n'
        + '[boundary.outlet]\non = "outlet"\noutflow = true\n'
    )


def disc(name: str, center: tuple[float, float], radius: float) -> str:
    """The table of a round hole [m]."""
    return f"[shape.holes.{name}]\ncircle = {{ center = {list(center)}, radius = {radius!r} }}\n"


CAVITY = (
    f'{HEAD}[parameters]\nRe = 100\n{SQUARE}[fluid]\nrho = 1\nmu = "1/Re"\n'
    '[boundary.lid]\non = "top"\nvelocity = [1, 0]\n'
)
"""A square whose lid moves at 1 m/s; its corners stand still."""

CYLINDER = disc("cylinder", (0.2, 0.2), 0.05)
FLUID, ENTERING = "rho = 1\nmu = 1e-3\n", "4*U*y*(0.41 - y)/0.41^2"
SLOWLY = "[parameters]\nU = 0.3\n"
CHANNEL = channel(2.2, 0.41, FLUID, ENTERING, SLOWLY + CYLINDER)
"""A cylinder in a channel, of the priority research programme of the DFG: velocity U in the middle of the inlet."""
SYMMETRIC_CHANNEL = HEAD + SLOWLY + through(FLUID, ENTERING) + '[mesh]\nfile = "channel.msh"\n'
"""The same on a mesh of a file beside the scene, that of `mirrored_channel`."""

ZONE = "[shape.regions.zone]\npolygon = [[0.1, 0.1], [0.4, 0.1], [0.4, 0.31], [0.1, 0.31]]\n"
"""Around the cylinder and behind it, for a finer mesh there."""


def forces(speed: float) -> str:
    """The [quantities] of the cylinder, whose coefficients count on a mean speed [m/s]."""
    of = f'{{ speed = {speed!r}, length = 0.1 }}, at = "cylinder" }}\n'
    return (
        f"[quantities]\ndrag = {{ drag_coefficient = {of}lift = {{ lift_coefficient = {of}"
        f"street = {{ strouhal = {of}"
        'entering = { flux = true, at = "inlet" }\nleaving = { flux = true, at = "outlet" }\n'
    )


def kovasznay(decay: float, mu: float) -> str:
    """Kovasznay's flow in a square, by its velocity on all sides."""
    return (
        f"{HEAD}[parameters]\nl = {decay!r}\n{SQUARE}[fluid]\nrho = 1\nmu = {mu!r}\n"
        + '[boundary.sides]\non = "outline"\nvelocity = ["1 - exp(l*x)*cos(2*pi*y)", "l/(2*pi)*exp(l*x)*sin(2*pi*y)"]\n'
        + STEADY
    )


def everywhere(velocity: str, rest: str, mu: float = 0.05, tolerance: float = 1e-11, size: float = 0.1) -> str:
    """A square with a round window in it, the same velocity prescribed on both."""
    return (
        f"{HEAD}{SQUARE}{disc('window', (0.4, 0.5), 0.15)}[fluid]\nrho = 1.2\nmu = {mu!r}\n"
        + f'[boundary.sides]\non = ["outline", "window"]\nvelocity = {velocity}\n'
        + rest
        + f"[solve]\ntolerance = {tolerance!r}\n[mesh]\nsize = {size!r}\n"
    )
