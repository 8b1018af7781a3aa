"""Scenes on which ways to rest are compared: `restshape bench drape`. Half of them have openings that bodies are in."""

from collections.abc import Sequence
from pathlib import Path

from restshape.application import application

SHIPPED = ("sphere", "cylinder", "hanging", "pins", "random")
"""Scenes that ship with the application, and are among them."""
HEAD = """format = "restshape-scene"
version = 1
app = "couture"
"""
FABRICS = {
    "linen": ("1 MPa", 500, "0.4 mm", "1e-5 N m"),
    "cotton": ("1 MPa", 500, "0.36 mm", "1e-5 N m"),
    "wool": ("1 MPa", 400, "0.8 mm", "2e-5 N m"),
    "silk": ("1 MPa", 400, "0.15 mm", "1e-6 N m"),
    "viscose": ("0.5 MPa", 500, "0.3 mm", "5e-6 N m"),
    "polyester": ("2 MPa", 550, "0.2 mm", "4e-6 N m"),
    "felt": ("1 MPa", 200, "2 mm", "2e-4 N m"),
}
"""Young's modulus, density [kg/m^3], thickness and bending stiffness."""
Point = Sequence[float]


def sheet(left: float, bottom: float, right: float, top: float) -> str:
    """A rectangle between these coordinates [m]."""
    return f"""
[shape]
outline = ["bottom", "right", "top", "left"]
[shape.vertices]
a = [{left}, {bottom}]
b = [{right}, {bottom}]
c = [{right}, {top}]
d = [{left}, {top}]
[shape.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
"""


def disc(radius: float) -> str:
    """A disc of this radius [m] about the origin."""
    return f"""
[shape]
outline = ["lower", "upper"]
[shape.vertices]
west = [{-radius}, 0]
east = [{radius}, 0]
[shape.edges]
lower = {{ arc = ["west", "east"], bulge = 1 }}
upper = {{ arc = ["east", "west"], bulge = 1 }}
"""


def holes(**of: tuple[float, float, float]) -> str:
    """Round holes by name: x, y and radius [m]."""
    lines = [f"{name} = {{ circle = {{ center = [{x}, {y}], radius = {r} }} }}" for name, (x, y, r) in of.items()]
    return "\n".join(["[shape.holes]", *lines, ""])


def fabric(name: str) -> str:
    """The material of that name."""
    E, rho, thickness, bending = FABRICS[name]
    return (
        f'[material.{name}]\nE = "{E}"\nnu = 0.3\nrho = "{rho} kg/m^3"\nthickness = "{thickness}"\n'
        f'bending = "{bending}"\n'
    )


def pinned(**on: str) -> str:
    """Pins by name, on parts of the pattern."""
    return "".join(f'[supports.{name}]\non = "{part}"\nfix = ["x", "y", "z"]\n' for name, part in on.items())


def ball(name: str, center: Point, radius: float, friction: float = 0.35) -> str:
    """A sphere."""
    return f"[bodies.{name}]\nsphere = {{ center = {list(center)}, radius = {radius} }}\nfriction = {friction}\n"


def capsule(name: str, start: Point, end: Point, radius: float, friction: float = 0.4) -> str:
    """A capsule."""
    form = f"{{ start = {list(start)}, end = {list(end)}, radius = {radius} }}"
    return f"[bodies.{name}]\ncapsule = {form}\nfriction = {friction}\n"


def box(name: str, center: Point, half: Point, turn: float = 0.0, rounded: float = 0.004) -> str:
    """A box, turned about z by an angle [deg]."""
    form = f'{{ center = {list(center)}, half = {list(half)}, rotate = [0, 0, "{turn} deg"], radius = {rounded} }}'
    return f"[bodies.{name}]\nbox = {form}\nfriction = 0.4\n"


def floor(height: float) -> str:
    """A rough floor."""
    return f"[bodies.floor]\nplane = {{ point = [0, 0, {height}], normal = [0, 0, 1] }}\nfriction = 0.3\n"


def start(turn: Sequence[str] = ("0 deg",) * 3, move: Point = (0, 0, 0)) -> str:
    """Where the flat cloth lies at first."""
    angles = ", ".join(f'"{angle}"' for angle in turn)
    return f"[start]\nturn = [{angles}]\nmove = {list(move)}\n"


def scene(title: str, size: float, *parts: str) -> str:
    """A scene under gravity with a mesh of this size [m]; there is contact where there is a body."""
    contact = "[effects.contact]\n" if any("[bodies." in part for part in parts) else ""
    quantities = '[quantities]\nlowest = { displacement = "z", reduce = "min" }\npotential = { energy = "potential" }\n'
    return f'{HEAD}title = "{title}"\n{"".join(parts)}[effects.gravity]\n{contact}[mesh]\nsize = {size}\n{quantities}'


UPRIGHT = start(("90 deg", "0 deg", "0 deg"))
"""The pattern's y points upwards."""
BODY = (
    capsule("shoulders", (-0.15, 0, -0.1), (0.15, 0, -0.1), 0.07),
    capsule("trunk", (0, 0, -0.2), (0, 0, -0.6), 0.14),
    capsule("neck", (0, 0, -0.1), (0, 0, 0.05), 0.055),
    ball("head", (0, 0, 0.15), 0.1, 0.3),
)
"""A body of capsules whose shoulders are below the plane z = 0."""
SLOPING = (
    capsule("shoulder_left", (0, 0, -0.06), (-0.2, 0, -0.13), 0.055),
    capsule("shoulder_right", (0, 0, -0.06), (0.2, 0, -0.13), 0.055),
    capsule("trunk", (0, 0, -0.2), (0, 0, -0.5), 0.13),
    capsule("neck", (0, 0, -0.06), (0, 0, 0.08), 0.05),
)
"""Shoulders that fall off to both sides."""
TABLE = tuple(box(f"t{k}", (0, 0, -0.022), (0.3966, 0.0522, 0.02), 15.0 * k) for k in range(12))
"""A round table of 0.8 m made of boxes."""


def _on_bodies() -> dict[str, str]:
    """Cloth without openings, or whose openings hang freely."""
    curtain = sheet(0, 0, 0.4, 1.0) + fabric("linen") + pinned(rail="top") + UPRIGHT
    flag = sheet(0, 0, 0.9, 0.6) + fabric("polyester")
    scarf = sheet(-0.35, -0.35, 0.35, 0.35) + fabric("silk")
    over = start(("0 deg", "0 deg", "45 deg"), (-0.05, -0.05, 0))
    corner = box("table", (-0.4, -0.3, -0.372), (0.4, 0.3, 0.37), rounded=0.005)
    board = box("table", (0, 0, -0.022), (0.4, 0.4, 0.02))
    return {
        "curtain": scene("curtain clear of its floor", 0.03, curtain, floor(-0.01)),
        "long-curtain": scene("curtain that is too long for its floor", 0.03, curtain, floor(0.15)),
        "curtain-ball": scene(
            "curtain that a ball pushes", 0.03, curtain, floor(-0.01), ball("ball", (0.2, -0.05, 0.4), 0.08, 0.3)
        ),
        "flag": scene("flag from two pins", 0.03, flag, pinned(top="d", low="a"), UPRIGHT),
        "scarf": scene("scarf over the corner of a table", 0.025, scarf, corner, over),
        "ball": scene(
            "square scarf on a ball",
            0.03,
            sheet(-0.45, -0.45, 0.45, 0.45),
            fabric("silk"),
            ball("ball", (0, 0, -0.182), 0.18),
        ),
        "table": scene("square cloth on a square table", 0.04, sheet(-0.6, -0.6, 0.6, 0.6), fabric("cotton"), board),
        "round": scene("round cloth on a round table", 0.04, disc(0.7), fabric("cotton"), *TABLE),
        "skirt": scene(
            "circle skirt by its waist",
            0.04,
            disc(0.61),
            holes(waistline=(0, 0, 0.111)),
            fabric("viscose"),
            pinned(band="waistline"),
        ),
    }


def _around_bodies() -> dict[str, str]:
    """Cloth with an opening that a body, or its neck or waist, is in, or should come to be in."""
    square = sheet(-0.55, -0.55, 0.55, 0.55)
    neck = square + holes(neckline=(0, 0, 0.11)) + fabric("wool")
    tight = square + holes(neckline=(0, 0, 0.07)) + fabric("wool") + start(move=(0, 0, 0.255))
    hips = (
        capsule("waist", (0, 0, -0.1), (0, 0, 0.2), 0.09),
        capsule("hips", (-0.05, 0, -0.2), (0.05, 0, -0.2), 0.14),
    )
    return {
        "poncho": scene("poncho on a body of capsules", 0.03, neck, *BODY),
        "poncho-sloping": scene("poncho on shoulders that fall off", 0.03, neck, *SLOPING),
        "poncho-tight": scene("poncho whose hole is 60 mm less than the head", 0.03, tight, *BODY),
        "skirt-on-hips": scene(
            "circle skirt that rests on hips", 0.04, disc(0.5), holes(waistline=(0, 0, 0.11)), fabric("viscose"), *hips
        ),
        "skirt-over-hips": scene(
            "circle skirt held by its waist over hips",
            0.04,
            disc(0.61),
            holes(waistline=(0, 0, 0.111)),
            fabric("viscose"),
            pinned(band="waistline"),
            *hips,
        ),
        "collar": scene(
            "narrow collar on shoulders", 0.02, disc(0.2), holes(neckline=(0, 0, 0.1)), fabric("felt"), *SLOPING
        ),
    }


def _around_things() -> dict[str, str]:
    """Cloth with openings that posts, pegs, an arm or a bottle are in, or should come to be in."""
    post = capsule("post", (0, 0, -0.4), (0, 0, 0.3), 0.025)
    board = box("table", (0, 0, -0.022), (0.4, 0.4, 0.02))
    sleeve = disc(0.25) + holes(armhole=(0, 0, 0.09)) + fabric("cotton")
    mask = (
        sheet(-0.12, -0.08, 0.12, 0.08)
        + holes(first=(-0.095, 0.04, 0.014), second=(0.095, 0.04, 0.014))
        + fabric("felt")
    )
    pegs = (
        capsule("peg_left", (-0.095, -0.05, 0.04), (-0.095, 0.05, 0.04), 0.008),
        capsule("peg_right", (0.095, -0.05, 0.04), (0.095, 0.05, 0.04), 0.008),
    )
    yoke = sheet(-0.4, -0.2, 0.4, 0.2) + holes(first=(-0.2, 0, 0.06), second=(0.2, 0, 0.06)) + fabric("linen")
    posts = [capsule(name, (x, 0, -0.3), (x, 0, 0.15), 0.03) for name, x in (("post_left", -0.2), ("post_right", 0.2))]
    heads = [ball(name, (x, 0, -0.13), 0.09) for name, x in (("under_left", -0.2), ("under_right", 0.2))]
    bottle = capsule("bottle", (0, 0, -0.3), (0, 0, -0.06), 0.07), capsule("spout", (0, 0, -0.06), (0, 0, 0.12), 0.02)
    return {
        "table-post": scene(
            "tablecloth with a hole over a post",
            0.035,
            sheet(-0.55, -0.55, 0.55, 0.55),
            holes(hole=(0, 0, 0.05)),
            fabric("cotton"),
            board,
            post,
        ),
        "mask": scene("mask that hangs from two pegs by its holes", 0.008, mask, *pegs, UPRIGHT),
        "sleeve": scene(
            "ring of cloth that hangs from an arm",
            0.025,
            sleeve,
            capsule("arm", (0, -0.3, 0), (0, 0.3, 0), 0.04),
            UPRIGHT,
        ),
        "yoke": scene("yoke with two holes over two posts", 0.025, yoke, *posts, *heads),
        "bottle": scene(
            "disc with a hole on a bottle", 0.03, disc(0.3), holes(hole=(0, 0, 0.035)), fabric("cotton"), *bottle
        ),
    }


def drapes() -> dict[str, str | Path]:
    """All scenes by name: texts, and files of those that ship."""
    shipped = {path.stem: path for path in application("couture").scenes() if path.stem in SHIPPED}
    return {**_on_bodies(), **_around_bodies(), **_around_things(), **{name: shipped[name] for name in SHIPPED}}
