"""Scenes of cloth and edits whose frames are timed: `restshape bench drags`."""

from __future__ import annotations

from typing import Any

from restshape_verification.couture.drapes import (
    UPRIGHT,
    ball,
    disc,
    fabric,
    floor,
    holes,
    pinned,
    scene,
    sheet,
)

Edits = list[dict[str, Any]]
FRAMES = 12
"""Frames of each way of the hand."""


def _there_and_back(key: str, there: float, back: float) -> Edits:
    """A number of the scene that goes somewhere and back."""
    return [{"do": "set", "key": key, "value": value, "frames": FRAMES} for value in (there, back)]


def drags() -> dict[str, tuple[str, Edits]]:
    """Scenes and edits by name."""
    curtain = sheet(0, 0, 0.4, 1.0) + fabric("linen") + pinned(rail="top") + UPRIGHT
    second = '[supports.second]\non = "c"\nfix = { x = -0.3, y = 0, z = 0 }\n'
    flag = sheet(0, 0, 0.9, 0.6) + fabric("polyester") + pinned(first="d") + second + UPRIGHT
    skirt = disc(0.61) + holes(waistline=(0, 0, 0.111)) + fabric("viscose") + pinned(band="waistline")
    grown = [{"do": "scale", "on": "outline", "factor": 1.06, "frames": FRAMES}]
    pulled: Edits = [
        {"do": "press", "on": "east"},
        {"do": "drag", "to": [0.69, 0.0], "frames": FRAMES},
        {"do": "release"},
    ]
    point = "bodies.floor.plane.point.2"
    pushed = ball("ball", (0.2, -0.1, 0.4), 0.08, 0.3)
    return {
        "strip over a floor": (
            scene("curtain that its floor pushes", 0.03, curtain, floor(-0.01)),
            _there_and_back(point, 0.002, -0.01),
        ),
        "strip over a floor, 20 mm a frame": (
            scene("curtain that its floor pushes", 0.03, curtain, floor(-0.01)),
            _there_and_back(point, 0.23, -0.01),
        ),
        "skirt whose pattern is edited": (scene("circle skirt by its waist", 0.04, skirt), [*grown, *pulled]),
        "flag whose pin is dragged": (
            scene("flag from two pins", 0.03, flag),
            _there_and_back("supports.second.fix.x", -0.6, -0.3),
        ),
        "curtain that a ball pushes": (
            scene("curtain that a ball pushes", 0.0148, curtain, floor(-0.01), pushed),
            _there_and_back("bodies.ball.sphere.center.1", 0.02, -0.1),
        ),
    }
