"""Scenes of a rubber tower that vibrates, of any application that moves plane solids."""

from pathlib import Path

from restshape_studies.stability.scenery import block, head, meshed, write_scene

RUBBER = '\n[material.rubber]\nE = "2 MPa"\nnu = 0.3\nrho = 1000\nthickness = 0.1\n'
FOOT = '\n[supports.foot]\non = "bottom"\nfix = ["x", "y"]\n'
SHAKEN = "\n[effects.ground]\ndirection = [2, 1]\nacceleration = 3.0\nfrequency = 4.0\n"
WINDOW = "\n[shape.holes]\nwindow = { circle = { center = [0.5, 1.4], radius = 0.18 } }\n"
QUANTITIES = """
[quantities]
sway = { displacement = "x", at = "c" }
amplitude = { displacement = "x", at = "c", reduce = "peak" }
energy = { energy = "total" }
edit = { energy = "edit" }
remesh = { energy = "remesh" }
"""


def dynamics(dt: float = 0.01, steps: int = 10, **more: object) -> str:
    """The [effects.dynamics] and [solve] with a tight tolerance."""
    rest = "".join(f"{key} = {value!r}\n" for key, value in more.items())
    return f"\n[effects.dynamics]\ntime_step = {dt!r}\nsteps = {steps}\n{rest}\n[solve]\ntolerance = 1e-12\n"


def tower(app: str, folder: Path, *parts: str, size: float = 0.2, window: bool = False, more: str = "") -> Path:
    """The scene file of a 1 m x 2 m rubber tower on its foot, with a round window near its top if wanted.

    Args:
        app: application; folder: of the file.
        parts: tables of the scene beside; more: lines of its quantities.
        size: of the mesh [m].
        window: whether there is one.
    """
    shape = block(1.0, 2.0) + (WINDOW if window else "")
    return write_scene(folder, head(app) + shape + RUBBER + FOOT + meshed(size) + "".join(parts) + QUANTITIES + more)
