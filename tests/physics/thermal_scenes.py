"""Scenes of heat conduction for tests, whose exact temperatures are known."""

from pathlib import Path

import numpy as np
from restshape_studies.stability.scenery import write_scene

from restshape.interface.first_frame import first_frame
from restshape.replay.loop import Replay

HEAD = 'format = "restshape-scene"\nversion = 1\napp = "conduction"\n'
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
STEADY = "1 + sin(pi*x)*sin(pi*y) + x*x*y"
MANUFACTURED = (
    HEAD
    + SQUARE
    + "[shape.holes.pipe]\ncircle = { center = [0.5, 0.5], radius = 0.2 }\n"
    + "[material.m]\nconductivity = 2\nthickness = 0.1\n"
    + f'[supports.walls]\non = ["left", "bottom"]\nfix = {{ temperature = "{STEADY}" }}\n'
    + '[loads.inside]\non = "all"\nsource = "2*(2*pi^2*sin(pi*x)*sin(pi*y) - 2*y)"\n'
    + '[loads.right]\non = "right"\nflux = "2*(-pi*sin(pi*y) + 2*y)"\n'
    # k dT/dn = film (ambient - T), with a film that varies.
    + '[loads.top]\non = "top"\n'
    + 'convection = { film = "5 + 9*x*x*y", ambient = "1 + x*x + 2/(5 + 9*x*x)*(-pi*sin(pi*x) + x*x)" }\n'
    + f'[supports.pipe]\non = "pipe"\nfix = {{ temperature = "{STEADY}" }}\n'
    + "[solve]\ntolerance = 1e-11\n[mesh]\nsize = 0.1\norder = 2\n"
)
"""A square with a round hole; every kind of load and support gives 1 + sin(pi x) sin(pi y) + x^2 y."""

ANNULUS = (
    HEAD
    + "[shape]\noutline = "
    + '["e1", "e2"]\n[shape.vertices]\na = [0.2, 0]\nb = [-0.2, 0]\n'
    + '[shape.edges]\ne1 = { arc = ["a", "b"], through = [0, 0.2] }\ne2 = { arc = ["b", "a"], through = [0, -0.2] }\n'
    + "[shape.holes.pipe]\ncircle = { center = [0, 0], radius = 0.1 }\n"
    + "[material.m]\nconductivity = 15\n"
    + '[supports.pipe]\non = "pipe"\nfix = { temperature = 400 }\n'
    + '[loads.air]\non = "outline"\nconvection = { film = 50, ambient = 300 }\n'
    + "[solve]\ntolerance = 1e-10\n[mesh]\nsize = 0.02\norder = 2\n"
    + '[quantities]\nouter = { temperature = true, at = "e1" }\n'
    + 'entered = { heat_flow = true, at = "pipe" }\nleft1 = { heat_flow = true, at = "e1" }\n'
    + 'left2 = { heat_flow = true, at = "e2" }\n'
)
"""A pipe of radii 0.1 and 0.2 m, held at 400 K inside, in air of 300 K."""

COOLING = (
    HEAD
    + SQUARE
    + "[material.m]\nconductivity = 2\nthickness = 0.2\nrho = 100\nspecific_heat = 3\n"
    + '[supports.walls]\non = ["left", "right"]\nfix = { temperature = 0 }\n'
    + "[effects.storage]\ntime_step = 0.5\nsteps = 1\ninitial = 0\n"
    + "[solve]\ntolerance = 1e-11\n[mesh]\nsize = 0.05\norder = 2\n"
)
"""A plate between two cold walls: its first mode sin(pi x) decays at the rate k pi^2/(rho c) [1/s], thick or thin."""


def steady(X: np.ndarray) -> np.ndarray:
    """The temperature of `MANUFACTURED` at places X (n, 2) [m]."""
    x, y = X.T
    return 1 + np.sin(np.pi * x) * np.sin(np.pi * y) + x * x * y


def solved(folder: Path, text: str, *overrides: str) -> Replay:
    """The replay of a scene's first shape."""
    return first_frame(write_scene(folder, text), list(overrides))
