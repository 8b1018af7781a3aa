"""Small scenes of cloth for tests."""

from pathlib import Path

from small_scenes import block, head

from restshape.scene.load import load_scene
from restshape.scene.model import Scene

HEAD = head("cloth")

CLOTH = f"""
{HEAD}[parameters]
tilt = "30 deg"
half = 0.5
{block()}[shape.regions]
patch = {{ polygon = [[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]] }}
[material.cotton]
E = "2 MPa"
nu = 0.25
rho = "400 kg/m^3"
thickness = "0.5 mm"
[effects.gravity]
[mesh]
size = 0.25
"""
"""A square of cotton 1 m wide, which nothing holds yet."""

BALL = """
[bodies.ball]
sphere = { center = [0.5, "half", -0.3], radius = "25 cm" }
friction = 0.3
"""
CONTACT = "[effects.contact]\n"
PIN = """
[supports.pin]
on = "a"
fix = ["x", "y", "z"]
"""


def write_cloth(folder: Path, *parts: str) -> Path:
    """The file of the square of cotton with further tables."""
    path = folder / "cloth.toml"
    path.write_text("\n".join([CLOTH, *parts]))
    return path


def cloth(folder: Path, *parts: str, overrides: tuple[str, ...] = ()) -> Scene:
    """The square of cotton with further tables, read."""
    return load_scene(write_cloth(folder, *parts), overrides)
