"""The cases that peers are compared in: an installed scene, an edit of it, and what a peer must know of its physics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Events = list[dict[str, Any]]
FINITE_ELEMENTS = ("dolfinx", "scikit-fem", "ngsolve", "freefem")
"""Peers that solve what their user writes down as weak forms."""


@dataclass(frozen=True)
class PeerCase:
    """One case.

    Args:
        name: of the case; title: for people.
        problem: which program of a peer computes it.
        scene: the installed application and its scene; overrides: as after --set.
        events: of the edit, given the number of frames.
        parameters: numbers and names of the physics that a peer is handed, those of the scene.
        answer: the field that is compared, or "frequencies".
        tolerance: largest distance of a peer's answers, relative in the L2 norm of all nodes or modes; for the same
            elements far below what the mesh costs, for other elements what it costs.
        policy: restshape's.
        frames: that are timed; 0: the first one alone, from nothing.
        peers: that have this kind of physics.
        note: what is to be known of the comparison.
    """

    name: str
    title: str
    problem: str
    scene: str
    events: Callable[[int], Events]
    parameters: dict[str, Any]
    answer: str
    tolerance: float
    overrides: tuple[str, ...] = ()
    policy: str = "auto"
    frames: int = 20
    note: str = ""
    peers: tuple[str, ...] = FINITE_ELEMENTS


def drag(on: str, at: tuple[float, float], step: tuple[float, float]) -> Callable[[int], Events]:
    """A hand that takes hold of an entity at a place [m] and goes on by a step [m] a frame."""

    def events(frames: int) -> Events:
        to = [place + frames * way for place, way in zip(at, step)]
        return [{"do": "press", "on": on, "at": list(at)}, {"do": "drag", "to": to, "frames": frames}]

    return events


def rest(frames: int) -> Events:
    """Nothing is edited."""
    return [{"do": "idle", "frames": frames}]


def isotropic(E: float, nu: float, plane_stress: bool) -> dict[str, float]:
    """Lamé's numbers [Pa] of a solid in the plane."""
    lam = E * nu / (1 - nu**2) if plane_stress else E * nu / ((1 + nu) * (1 - 2 * nu))
    return {"lam": lam, "mu": E / (2 * (1 + nu))}


PLATE = isotropic(210e9, 0.3, True) | {"fixed": ["left"], "pulled": ["right"], "traction": [100e6, 0.0]}
PULLED = ("window", (0.43, 0.52))
CANTILEVER = isotropic(10e6, 0.4, False) | {
    "body_force": [0.0, -9810.0],
    "fixed": ["wall"],
    "pressed": ["bottom"],
    "pressure": 250.0,
}
BEAM = isotropic(1.4e6, 0.4, False) | {
    "body_force": [0.0, -2000.0],
    "fixed": ["left"],
    "pressed": [],
    "pressure": 0.0,
    "rho": 1000.0,
    "time_step": 0.005,
}
BAR = isotropic(70e9, 0.33, True) | {"rho": 2700.0, "thickness": 0.004, "shear_factor": 5 / 6, "modes": 5}
AIR = [f"{part}{k}" for k in (1, 2, 3) for part in ("top", "out", "tip", "in")] + ["top4"]
FINS = {
    "conductivity": 167.0,
    "capacity": 896.0 * 2700.0,
    "heated": ["chip"],
    "flux": 3000.0,
    "cooled": AIR,
    "film": 40.0,
    "ambient": 293.15,
    "initial": 293.15,
    "time_step": 10.0,
}
STREAM = {
    "rho": 1.2,
    "viscosity": 1.8e-5,
    "inlet": ["inlet"],
    "speed": 0.02,
    "slip": ["lower", "upper"],
    "walls": ["nose", "belly", "back"],
}
COTTON = {
    "lam": 300.0 * 0.3 / (1 - 0.3**2),
    "mu": 300.0 / (2 * (1 + 0.3)),
    "bending": 5e-6,
    "density": 0.15,
    "gravity": 9.81,
    "pins": [["left", "top"], ["right", "top"]],
    "residual": 1e-4,
}
STORAGE = ("effects.storage.time_step=10", "effects.storage.initial='20 degC'", "effects.storage.steps=1")
SAME = "peers are handed the mesh; the mesher's time counts for restshape alone"

CASES = {
    case.name: case
    for case in (
        PeerCase(
            "static-2000",
            "linear static, about 2,000 triangles, moved geometry (level 1)",
            "static",
            "solid/plate",
            drag(*PULLED, (0.001, 0.0)),
            PLATE,
            "displacement",
            1e-4,
        ),
        PeerCase(
            "static-20000",
            "linear static, about 20,000 triangles, moved geometry (level 1)",
            "static",
            "solid/plate",
            drag(*PULLED, (0.0005, 0.0)),
            PLATE,
            "displacement",
            1e-4,
            ("mesh.size='15.6 mm'",),
        ),
        PeerCase(
            "new-mesh-2000",
            "linear static, about 2,000 triangles, a new mesh in each frame",
            "static",
            "solid/plate",
            drag(*PULLED, (0.001, 0.0)),
            PLATE,
            "displacement",
            1e-4,
            policy="rebuild",
            note=SAME,
        ),
        PeerCase(
            "new-mesh-20000",
            "linear static, about 20,000 triangles, a new mesh in each frame",
            "static",
            "solid/plate",
            drag(*PULLED, (0.0005, 0.0)),
            PLATE,
            "displacement",
            1e-4,
            ("mesh.size='15.6 mm'",),
            policy="rebuild",
            frames=6,
            note=SAME,
        ),
        PeerCase(
            "large-990",
            "St. Venant-Kirchhoff, 990 triangles, weight and a following pressure, moved geometry (level 1)",
            "large_deformation",
            "cantilever/cantilever",
            drag("tip", (2.0, 0.125), (0.001, 0.0)),
            CANTILEVER,
            "displacement",
            1e-4,
        ),
        PeerCase(
            "newmark",
            "a step of Newmark's method, St. Venant-Kirchhoff, about 1,400 triangles, the shape stays",
            "motion",
            "vibration/csm3",
            rest,
            BEAM,
            "displacement",
            1e-3,
            ("mesh.order=1", "mesh.size='3.5 mm'", "effects.dynamics.steps=1"),
            note="the shape stays as it is: each program keeps the velocities of an edited shape in a way of its own",
        ),
        PeerCase(
            "modes",
            "five modes of a free plate with shear, about 2,300 triangles, moved geometry (level 1)",
            "modes",
            "metallophone/bar_100",
            drag("right", (0.1, 0.015), (0.0002, 0.0)),
            BAR,
            "frequencies",
            0.01,
            ("effects.modal.model='plate'", "effects.modal.modes=5", "mesh.size='1.8 mm'"),
            frames=10,
            note="peers have no such triangle: theirs is of second order, four times the unknowns on the same mesh",
        ),
        PeerCase(
            "heat",
            "a step of conduction in time, about 1,500 triangles, moved geometry (level 1)",
            "heat",
            "thermal/fins",
            drag("tip1", (0.051, 0.038), (0.0, 0.0001)),
            FINS,
            "temperature",
            1e-3,
            ("mesh.order=1", *STORAGE),
        ),
        PeerCase(
            "flow",
            "a frame of steady incompressible flow, about 1,400 triangles, moved geometry (level 1)",
            "flow",
            "flow/steady_flow",
            drag("tail", (0.06, 0.0), (0.0, -0.0002)),
            STREAM,
            "velocity",
            0.03,
            frames=10,
            note="peers take Taylor and Hood's elements, of second order; restshape stabilised ones of first order",
        ),
        PeerCase(
            "drape",
            "a square of cotton that falls from its pattern, hangs from two pins, to a residual of 1e-4 of the weight",
            "drape",
            "couture/pins",
            rest,
            COTTON,
            "displacement",
            0.01,
            ("effects.cloth.bending='nonlinear'",),
            frames=0,
            note="the peer has a neo-Hookean membrane and single precision; its forces are found in double precision",
            peers=("newton",),
        ),
    )
}
