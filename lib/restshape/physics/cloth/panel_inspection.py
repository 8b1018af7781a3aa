"""Where panels lie in the pattern plane, and regions of cloth that one half of a panel on the fold has alone."""

from __future__ import annotations

import math

from restshape.scene.dart_keys import IMAGE
from restshape.scene.model import Scene
from restshape.scene.panels import frames_of
from restshape.scene.physics import Inspection


def half_regions(scene: Scene) -> list[str]:
    """What there is to doubt of materials in a region of a panel on the fold, whose image has another material."""
    filled = {region: name for name, one in scene.material.items() for region in one.region or ()}
    found = []
    for region, name in filled.items():
        panel, _, own = region.partition(".")
        half = own.removeprefix(f"{IMAGE}.")
        other = f"{panel}.{IMAGE}.{own}" if half == own else f"{panel}.{half}"
        if other in scene.shape.regions and filled.get(other) != name:
            found.append(
                f"material.{name}.region: {region} is of {name}, and its image {other} is not: name both, "
                f'region = ["{region}", "{other}"], if both halves are meant'
            )
    return found


def inspect_panels(scene: Scene) -> Inspection:
    """What `restshape check` shows of panels: where their own coordinates lie, in which events give no places."""
    frames = frames_of(scene)
    rows = []
    for name, frame in frames.items():
        turn = f", turned by {math.degrees(frame.angle):.6g} deg" if frame.angle else ""
        rows.append((f"place of {name}", f"({1e3 * frame.x:.6g}, {1e3 * frame.y:.6g}) mm{turn} in the pattern plane"))
    data = {name: {"at": [frame.x, frame.y], "angle": frame.angle} for name, frame in frames.items()}
    return Inspection({"panel_places": data} if data else {}, rows, tuple(half_regions(scene)))
