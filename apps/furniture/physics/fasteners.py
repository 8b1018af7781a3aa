"""Strength of fasteners and woods, from `fasteners.toml` and `woods.toml` beside this module."""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from math import pi, sqrt
from typing import Any

from restshape.errors import UserError
from restshape.scene.units import quantity


@dataclass(frozen=True)
class Wood:
    """A wood: densities [kg/m^3], specific gravity, E, bending strength, what the mantle of a glued dowel bears [Pa].

    E and bending strength of solid wood are along its fibres; `E_across` and `tension_across` [Pa] are what it has
    across them. A panel has no grain: its edges hold a fastener less well than its faces, and `edge_shear` [N] is all
    the shear that one is known to bear in them.
    """

    name: str
    density: float
    characteristic_density: float
    gravity: float
    E: float
    bending: float
    mantle: float
    source: str
    panel: bool = False
    edge_shear: float = 0.0
    E_across: float = 0.0
    tension_across: float = 0.0

    @property
    def modulus_across(self) -> float:
        """Young's modulus across its fibres [Pa], of a panel that of all directions."""
        return self.E if self.panel else self.E_across

    @property
    def strength_across(self) -> float:
        """What it bears in bending across its fibres [Pa], which is its strength in tension there."""
        return self.bending if self.panel else self.tension_across


@dataclass(frozen=True)
class Fastener:
    """A fastener: length and diameters [m], pull strength [N/m] or the name of its formula, shear strength [N] or the
    name of its formula, strength of what it is made of [Pa].

    `end_grain` is what of its pull and shear strength is left in the end grain of solid wood, `edge_pull` the name of
    the formula in the edges of panels of `least_edge` [m] and more; without one it is not known to hold there.
    """

    name: str
    length: float
    diameter: float
    pull: float | str
    shear: float | str
    source: str
    core: float = 0.0
    head: float = 0.0
    tensile: float = 0.0
    end_grain: tuple[float, float] = (1.0, 1.0)
    edge_pull: str = ""
    least_edge: float = 0.0

    def pull_strength(self, wood: Wood, through: Wood, thickness: float, edge: float) -> float:
        """The pull [N] that one bears through a plank into the end of another: it, or its head, gives way.

        Args:
            wood, edge: of the plank in whose end it is, its wood and thickness [m].
            through, thickness: of the plank through whose face it goes.

        Raises:
            UserError: it does not reach through the plank, or nothing is known of its strength there.
        """
        into = self.length - thickness
        if into <= 0.0:
            raise UserError(
                f"{self.name} of {self.length * 1e3:g} mm does not reach through {thickness * 1e3:g} mm",
                do="take a longer fastener or a thinner plank",
            )
        if not isinstance(self.pull, str):
            return self.pull * into
        if wood.panel:
            self._refuse_edge(wood, edge)
            strength = PULLS[self.edge_pull](self, wood, into)
        else:
            strength = PULLS[self.pull](self, wood, into) * self.end_grain[0]
        return min(strength, self._passing(through, thickness))

    def shear_strength(self, wood: Wood, through: Wood, thickness: float) -> float:
        """The shear [N] that one bears, through a plank of that wood and thickness [m] into the end of another wood."""
        if not isinstance(self.shear, str):
            return self.shear
        if wood.panel:
            return wood.edge_shear
        return SHEARS[self.shear](self, wood, through, thickness) * self.end_grain[1]

    def _refuse_edge(self, wood: Wood, edge: float) -> None:
        if not self.edge_pull:
            raise UserError(
                f"no strength of {self.name} in the edge of {wood.name} is known",
                do="take a screw or a dowel, or a solid wood",
            )
        if edge < self.least_edge - 1e-9:
            raise UserError(
                f"no strength of {self.name} is known in an edge of {edge * 1e3:g} mm of {wood.name}, "
                f"but from {self.least_edge * 1e3:g} mm on",
                do="take thicker planks or a solid wood",
            )

    def _passing(self, through: Wood, thickness: float) -> float:
        """The pull [N] at which it passes through the plank of its head, or out of it, where it has none."""
        if not self.head:
            return PULLS[self.pull](self, through, thickness)
        if not through.panel:
            # EN 1995-1-1 (8.26) in N/mm^2.
            return 70.0 * through.characteristic_density**2 * self.head**2
        # ETA-11/0190: 8 N/mm^2 from 12 to 20 mm and 10 beyond, and up to 400 N below.
        most = (10e6 if thickness > 0.02 else 8e6) * self.head**2
        return most if thickness >= 0.012 - 1e-9 else min(most, 400.0)


def _nail_pull(fastener: Fastener, wood: Wood, into: float) -> float:
    # 54.12 G^(5/2) D L in N and mm.
    return 54.12e6 * wood.gravity**2.5 * fastener.diameter * into


def _screw_pull(fastener: Fastener, wood: Wood, into: float) -> float:
    # 108.25 G^2 D L in N and mm.
    return 108.25e6 * wood.gravity**2 * fastener.diameter * into


def _panel_edge_pull(fastener: Fastener, wood: Wood, into: float) -> float:
    # 31.8 D^(1/2) (L - D/3)^(5/4) G^2 in N and mm.
    d, deep = 1e3 * fastener.diameter, 1e3 * into
    return 31.8 * sqrt(d) * max(deep - d / 3.0, 0.0) ** 1.25 * wood.gravity**2


def _mantle_pull(fastener: Fastener, wood: Wood, into: float) -> float:
    return pi * fastener.diameter * into * wood.mantle


def _nailed_shear(fastener: Fastener, wood: Wood, through: Wood, thickness: float) -> float:
    d = 1.1 * fastener.core if fastener.core else fastener.diameter
    # EN 1995-1-1 in N/mm^2 (8.15), or of panels (8.22), and (8.14) in N mm, d in mm.
    bearing = 82e3 * wood.characteristic_density * (1e3 * d) ** -0.3
    if through.panel:
        near = 65e6 * (1e3 * d) ** -0.7 * (1e3 * thickness) ** 0.1
    else:
        near = 82e3 * through.characteristic_density * (1e3 * d) ** -0.3
    moment = 0.3 * fastener.tensile * 1e-6 * (1e3 * d) ** 2.6 * 1e-3
    return johansen(near, bearing, thickness, fastener.length - thickness, d, moment)


def _dowelled_shear(fastener: Fastener, wood: Wood, through: Wood, thickness: float) -> float:
    d = fastener.diameter
    # EN 1995-1-1 (8.32), or of panels (8.37), and a round bar in bending.
    bearing = 82e3 * (1.0 - 10.0 * d) * wood.characteristic_density
    if through.panel:
        near = 50e6 * (1e3 * d) ** -0.6 * (1e3 * thickness) ** 0.2
    else:
        near = 82e3 * (1.0 - 10.0 * d) * through.characteristic_density
    return johansen(near, bearing, thickness, fastener.length - thickness, d, fastener.tensile * pi * d**3 / 32.0)


def johansen(f1: float, f2: float, t1: float, t2: float, d: float, moment: float) -> float:
    """The least shear [N] of a fastener in single shear without rope effect.

    Args:
        f1, f2: bearing strengths of the two members [Pa].
        t1, t2: lengths of the fastener in them [m].
        d: its diameter [m].
        moment: its yield moment [N m].

    Source: EN 1995-1-1:2004, (8.6) a to f.
    """
    b, r = f2 / f1, t2 / t1
    one = f1 * t1 * d
    return min(
        one,
        f2 * t2 * d,
        one / (1 + b) * (sqrt(b + 2 * b**2 * (1 + r + r**2) + b**3 * r**2) - b * (1 + r)),
        1.05 * one / (2 + b) * (sqrt(2 * b * (1 + b) + 4 * b * (2 + b) * moment / (f1 * d * t1**2)) - b),
        1.05
        * f1
        * t2
        * d
        / (1 + 2 * b)
        * (sqrt(2 * b**2 * (1 + b) + 4 * b * (1 + 2 * b) * moment / (f1 * d * t2**2)) - b),
        1.15 * sqrt(2 * b / (1 + b)) * sqrt(2 * moment * f1 * d),
    )


PULLS = {
    "wood_handbook_nail": _nail_pull,
    "wood_handbook_screw": _screw_pull,
    "wood_handbook_panel_edge": _panel_edge_pull,
    "mantle": _mantle_pull,
}
SHEARS = {"johansen": _nailed_shear, "johansen_dowel": _dowelled_shear}

DIMENSIONS = {
    "density": "density",
    "characteristic_density": "density",
    "E": "pressure",
    "E_across": "pressure",
    "bending": "pressure",
    "tension_across": "pressure",
    "mantle": "pressure",
    "edge_shear": "force",
    "length": "length",
    "diameter": "length",
    "core": "length",
    "head": "length",
    "least_edge": "length",
    "tensile": "pressure",
}


def _table(name: str) -> dict[str, dict[str, Any]]:
    return tomllib.loads((files(__package__) / name).read_text("utf-8"))


def _value(key: str, raw: Any, dimension: str | None) -> Any:
    if key == "end_grain":
        return tuple(raw)
    return quantity(raw, dimension) if dimension and isinstance(raw, str) else raw


def _wood(name: str, raw: dict[str, Any]) -> Wood:
    return Wood(name, **{key: _value(key, value, DIMENSIONS.get(key)) for key, value in raw.items()})


def _fastener(name: str, raw: dict[str, Any]) -> Fastener:
    given = {key: _value(key, value, DIMENSIONS.get(key)) for key, value in raw.items() if key not in ("pull", "shear")}
    pull = raw["pull"] if raw["pull"] in PULLS else quantity(raw["pull"], "stiffness")
    shear = raw["shear"] if raw["shear"] in SHEARS else quantity(raw["shear"], "force")
    return Fastener(name, pull=pull, shear=shear, **given)


WOODS: dict[str, Wood] = {name: _wood(name, raw) for name, raw in _table("woods.toml").items()}
FASTENERS: dict[str, Fastener] = {name: _fastener(name, raw) for name, raw in _table("fasteners.toml").items()}


def wood(name: str) -> Wood:
    """The wood of that name.

    Raises:
        UserError: there is none.
    """
    if name not in WOODS:
        raise UserError(f"there is no wood {name}", do=f"name one of {', '.join(WOODS)}")
    return WOODS[name]


def fastener(name: str) -> Fastener:
    """The fastener of that name.

    Raises:
        UserError: there is none.
    """
    if name not in FASTENERS:
        raise UserError(f"there is no fastener {name}", do=f"name one of {', '.join(FASTENERS)}")
    return FASTENERS[name]


@cache
def strengths(name: str, into: str, through: str, thickness: float, edge: float) -> tuple[float, float]:
    """The pull and the shear [N] that one fastener bears.

    Args:
        name: of the fastener.
        into, edge: of the plank in whose end it is, the name of its wood and its thickness [m].
        through, thickness: of the plank through whose face it goes.

    Raises:
        UserError: a name is unknown, or the fastener does not hold there: `Fastener.pull_strength`.
    """
    kind, woods = fastener(name), (wood(into), wood(through))
    return kind.pull_strength(*woods, thickness, edge), kind.shear_strength(*woods, thickness)
