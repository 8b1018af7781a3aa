"""What tolerances of a bar do to its tones: of its outline, its thickness and its material."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log, log2

import numpy as np
from restshape_apps.metallophone.rasping.outline_motion import (
    boundary_motion,
    edge_nodes,
    followed_inside,
    on_plane,
    outer_edges,
)

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.cli.options import print_table
from restshape.errors import UserError
from restshape.sensitivity.frequency_derivative import frequency_derivatives, material_derivatives, stands_alone

TENTH = 1e-4
"""A tenth of a millimetre [m]."""
CENTS = 1200.0 / log(2.0)
"""Cents of a small relative change of a frequency, over that change."""


@dataclass(frozen=True, eq=False)
class Tolerances:
    """By how many cents tones go up.

    Args:
        modes: ranks of the modes, from 1.
        frequencies: (modes,) [Hz] of them.
        kerf: (modes,) for a tenth of a millimetre that the cut takes off all around, holes included.
        thickness: (modes,) for a tenth of a millimetre more of thickness everywhere; not a number of plane solids.
        stiffness, density: by material, (modes,) for a per cent more of all its moduli, and of its density.
    """

    modes: tuple[int, ...]
    frequencies: np.ndarray
    kerf: np.ndarray
    thickness: np.ndarray
    stiffness: dict[str, np.ndarray]
    density: dict[str, np.ndarray]

    def rows(self) -> list[tuple[str, np.ndarray]]:
        """What is off by how much, in words, and what that does (modes,) [cents]."""
        found = [("0.1 mm of kerf all around", self.kerf), ("0.1 mm more of thickness", self.thickness)]
        for what, by_material in (("of E", self.stiffness), ("of rho", self.density)):
            single = len(by_material) == 1
            found += [(f"1 % more {what}" + ("" if single else f", {name}"), own) for name, own in by_material.items()]
        return found

    def of(self, ranks: Sequence[int]) -> "Tolerances":
        """Those of some of the modes alone, by rank from 1."""
        chosen = [self.modes.index(rank) for rank in ranks]
        stiffness, density = (
            {name: own[chosen] for name, own in by_material.items()} for by_material in (self.stiffness, self.density)
        )
        columns = (own[chosen] for own in (self.frequencies, self.kerf, self.thickness))
        return Tolerances(tuple(ranks), *columns, stiffness, density)

    def as_json(self) -> dict[str, object]:
        """The same for programs."""
        return {
            "modes": list(self.modes),
            "frequencies": self.frequencies.tolist(),
            "kerf_0.1_mm": self.kerf.tolist(),
            "thickness_0.1_mm": [None if np.isnan(own) else own for own in self.thickness.tolist()],
            "stiffness_1_percent": {name: own.tolist() for name, own in self.stiffness.items()},
            "density_1_percent": {name: own.tolist() for name, own in self.density.items()},
        }


def tolerances(analysis: ModalAnalysis) -> Tolerances:
    """The tolerances of a bar, by derivatives: no solve enters.

    Args:
        analysis: solved on the mesh as it lies.
    """
    body, space, f = analysis.state.body, analysis.state.space, analysis.frequencies
    mesh = space.mesh
    even = {edge: np.ones(len(edge_nodes(mesh, edge))) for edge in outer_edges(mesh)}
    inward = on_plane(analysis, followed_inside(mesh, boundary_motion(mesh, even)))
    kerf = TENTH * CENTS * frequency_derivatives(analysis, body.motion(inward[None])[0]) / f
    try:
        thicker = frequency_derivatives(analysis, body.thickness_motion(np.ones(len(space.X))))
    except UserError:
        thicker = np.full(len(f), np.nan)
    stiffness, density = _by_material(analysis)
    return Tolerances(tuple(range(1, len(f) + 1)), f.copy(), kerf, TENTH * CENTS * thicker / f, stiffness, density)


def print_tolerances(found: Tolerances) -> None:
    """Print the table of tolerances."""
    heads = ("tolerance", *(f"mode {k}: [cents]" for k in found.modes))
    rows = [(what, *(f"{cents:+.1f}" if np.isfinite(cents) else "–" for cents in own)) for what, own in found.rows()]
    print_table("what tolerances do to the tones", heads, rows, right=heads[1:])


def _by_material(analysis: ModalAnalysis) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Cents (modes,) for a per cent of the stiffness, and of the density, of each material."""
    materials, modes = analysis.state.scene.material, analysis.state.modes.chosen
    if len(materials) == 1:
        (name,) = materials
        up = np.full(len(modes), 600.0 * log2(1.01))
        return {name: up}, {name: -up}
    stiffness, density = (dict.fromkeys(materials, np.full(len(modes), np.nan)) for _ in range(2))
    found = [material_derivatives(analysis, int(mode)) if stands_alone(analysis, int(mode)) else {} for mode in modes]
    for name, material in materials.items():
        sizes = [own.get(name, {}) for own in found]
        scale = 0.01 * CENTS / analysis.frequencies
        moduli = [
            own.get("E", np.nan) * (material.E or 1.0) if "E" in own else own.get("stiffness", np.nan) for own in sizes
        ]
        stiffness[name] = scale * np.array(moduli)
        density[name] = scale * np.array([own.get("rho", np.nan) * material.rho for own in sizes])
    return stiffness, density
