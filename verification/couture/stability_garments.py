"""Hard cases of garments: panels inside and behind bodies, layers upside down, patchwork, tight sleeves, friction."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Statement, Trial, below, true
from restshape_studies.stability.scenery import meshed
from restshape_verification.couture.hard_scenes import (
    CONTACT,
    GRAVITY,
    HEAD,
    QUANTITIES,
    cloth,
    cotton,
    outside,
    played,
    resting,
)

from restshape.replay.loop import Replay

LIMB = """
[bodies.limb]
capsule = {{ start = [0, 0, -0.5], end = [0, 0, {top}], radius = {radius} }}
friction = {friction}
"""
TORSO = """
[bodies.torso]
capsule = {{ start = [0, 0, 0], end = [0, 0, 0.5], radius = 0.1 }}
friction = {friction}
"""
HIPS = """
[bodies.hips]
sphere = { center = [0, 0, 0], radius = 0.15 }
friction = FRICTION
"""
PANEL = """
[panels.{name}]
outline = ["bottom", "right", "top", "left"]
vertices = {{ a = [{left}, 0], b = [{right}, 0], c = [{top}, {height}], d = [-{top}, {height}] }}
[panels.{name}.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
"""
SIDES, PIECES, PITCH = 11, 121, 0.03
"""Squares along a side of the patchwork, all of them, and the side of each [m]."""


def panel(name: str, width: float, height: float, *keys: str, top: float | None = None) -> str:
    """A trapezium with keys of its placement, its own origin in the middle of its lower edge; `top`: width there."""
    sizes = {"left": -width / 2, "right": width / 2, "top": (width if top is None else top) / 2, "height": height}
    head, edges = PANEL.format(name=name, **sizes).split("\n[", 2)[1:]
    return f"\n[{head}\n" + "\n".join(keys) + f"\n[{edges}"


def seam(name: str, first: str, second: str) -> str:
    """A seam of two edges."""
    return f'\n[seams.{name}]\nfrom = "{first}"\nto = "{second}"\n'


def wrapped(body: str, radius: float, z: float) -> tuple[str, ...]:
    """Keys of a panel that is wrapped on a body."""
    return f'around = "{body}"', f"radius = {radius}", f"about = [0, 0, {z}]"


def garment(size: float, *tables: str) -> str:
    """A scene of panels of cotton under gravity, with a mesh of a size [m]."""
    return HEAD + cotton() + cloth() + GRAVITY + CONTACT + meshed(size) + QUANTITIES + "".join(tables)


def closed(made: Replay, row: dict, gap: float = 1e-3) -> Iterator[Statement]:
    """The statements that nothing crosses, no body comes through, and seams are closed to a gap [m]."""
    yield below("crossings", row["crossings"], 0)
    yield below("largest distance across a seam [m]", row["seam_gap"], gap)
    yield outside(made, 1e-3)


def begins_inside(trial: Trial) -> Iterator[Statement]:
    """A skirt that begins wholly inside the hips, at a third of their radius, rests on them from outside."""
    tube = panel("skirt", 0.92, 0.3, *wrapped("hips", 0.05, -0.1))
    text = garment(0.04, tube, seam("side", "skirt.left", "skirt.right"), HIPS.replace("FRICTION", "0.3"))
    made, rows = played(trial, text)
    yield from resting(made, rows, way=1e-8)
    yield from closed(made, rows[-1])
    yield true("it is said", "put outside, the nearest way" in rows[-1]["note"], rows[-1]["note"])


def behind_the_body(trial: Trial) -> Iterator[Statement]:
    """Both panels of a tube begin behind the limb that they are to go around: they fall past it, and it is said."""
    keys = 'turn = ["90 deg", 0, {turn}]', "move = [0, {y}, -0.1]"
    sides = [
        panel(name, 0.3, 0.2, *(key.format(turn=turn, y=y) for key in keys))
        for name, turn, y in (("front", "0", 0.1), ("back", '"180 deg"', 0.2))
    ]
    seams = seam("one", "front.left", "back.right") + seam("other", "front.right", "back.left")
    _, rows = played(trial, garment(0.05, *sides, seams, LIMB.format(top=0.3, radius=0.05, friction=0.3)))
    yield true("a note says that nothing catches it", "nothing catches" in rows[-1]["note"], rows[-1]["note"])
    yield below("crossings", rows[-1]["crossings"], 0)


def upside_down(trial: Trial) -> Iterator[Statement]:
    """Three layers of a tube that begin in the wrong order, and across each other, rest in the order asked for."""
    tubes, seams = "", ""
    for layer, radius in ((1, 0.175), (2, 0.172), (3, 0.16)):
        name = f"layer{layer}"
        tubes += panel(name, 0.9 + 0.01 * layer, 0.2, f"layer = {layer}", *wrapped("hips", radius, -0.05))
        seams += seam(name, f"{name}.left", f"{name}.right")
    made, rows = played(trial, garment(0.045, tubes, seams, HIPS.replace("FRICTION", "0.3")))
    yield from resting(made, rows, way=1e-8)
    yield from closed(made, rows[-1])
    problem = made.analysis.problem
    under = problem.ordered_layers.under(problem.corners(made.analysis.x))
    yield below("nodes under a lower layer", int(under.sum()), 0)
    yield true("it is said", "put outside of lower layers" in rows[-1]["note"], rows[-1]["note"])


def garment_frictions(trial: Trial) -> Iterator[Statement]:
    """A skirt with a waist tighter than the hips rests on them without friction, and with a coefficient of 2."""
    for friction in (0.0, 2.0):
        tube = panel("skirt", 1.0, 0.25, *wrapped("hips", 0.16, 0.0), top=0.8)
        bodies = HIPS.replace("FRICTION", str(friction)), TORSO.format(friction=friction)
        text = garment(0.045, tube, seam("side", "skirt.left", "skirt.right"), *bodies)
        made, rows = played(trial, text)
        yield from resting(made, rows, way=1e-8)
        yield from closed(made, rows[-1])


def nothing_holds(trial: Trial) -> Iterator[Statement]:
    """A wide tube slides off a limb without friction, and a panel without a seam falls beside one: it is said."""
    tube = panel("sleeve", 0.35, 0.1, *wrapped("limb", 0.0557, 0.0))
    loose = panel("loose", 0.1, 0.1, "move = [0.3, 0, 0]")
    sewn = seam("side", "sleeve.left", "sleeve.right")
    for parts, friction, words in (((), 0.0, "nothing catches the cloth"), ((loose,), 2.0, "nothing catches loose")):
        text = garment(0.05, tube, *parts, sewn, LIMB.format(top=0.2, radius=0.05, friction=friction))
        _, rows = played(trial, text)
        yield true(f"a note says that {words}", words in rows[-1]["note"], rows[-1]["note"])


def tight_sleeve(trial: Trial) -> Iterator[Statement]:
    """A sleeve of half the girth of its arm is sewn, twice as long as it was around, outside of the arm; it is said."""
    radius = 0.05
    tube = panel("sleeve", np.pi * radius, 0.1, *wrapped("limb", 0.5 * radius, 0.0))
    limb = LIMB.format(top=0.4, radius=radius, friction=0.5)
    text = garment(0.02, tube, seam("side", "sleeve.left", "sleeve.right"), limb)
    # Of rubber: cotton that is stretched so far presses with 10 kPa, for which contact by the weight is too soft.
    made, rows = played(trial, text.replace("1 MPa", "10 kPa"))
    yield from resting(made, rows, way=3e-8)
    yield from closed(made, rows[-1], 2e-3)
    yield true("it is said", "an edge is stretched by 1" in rows[-1]["untrusted"], rows[-1]["untrusted"])


def patchwork(trial: Trial) -> Iterator[Statement]:
    """A cloth of 121 panels of two triangles each, sewn together by 220 seams, hangs by two corners."""
    size = 2.0 * PITCH
    tables, seams = [], []
    for k in range(PIECES):
        i, j = divmod(k, SIDES)
        tables.append(panel(f"p{k}", PITCH, PITCH, f"move = [{PITCH * i}, {PITCH * j}, 0]"))
        if i:
            seams.append(seam(f"x{k}", f"p{k - SIDES}.right", f"p{k}.left"))
        if j:
            seams.append(seam(f"y{k}", f"p{k - 1}.top", f"p{k}.bottom"))
    pins = "".join(
        f'\n[supports.{name}]\non = "{on}"\nfix = ["x", "y", "z"]\n'
        for name, on in (("first", f"p{SIDES - 1}.d"), ("last", f"p{PIECES - 1}.c"))
    )
    text = garment(size, *tables, *seams, pins).replace(CONTACT, f"{CONTACT}self = true\n")
    made, rows = played(trial, text)
    yield below("triangles", len(made.analysis.problem.mesh.cells), 2 * PIECES)
    yield from resting(made, rows, way=1e-8)
    yield below("crossings", rows[-1]["crossings"], 0)
    yield below("largest distance across a seam [m]", rows[-1]["seam_gap"], 1e-3)


CASES = {
    "begins_inside": Case(begins_inside, weekly=("auto",)),
    "behind_the_body": Case(behind_the_body),
    "upside_down": Case(upside_down, weekly=("auto",)),
    "garment_frictions": Case(garment_frictions, weekly=("auto",)),
    "nothing_holds": Case(nothing_holds),
    "tight_sleeve": Case(tight_sleeve, weekly=("auto",)),
    "patchwork": Case(patchwork, weekly=("auto",)),
}
