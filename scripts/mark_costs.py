"""What marks of live sessions cost: of each application a drag, with the time of a frame, of its marks, and their size.

python scripts/mark_costs.py [--json]

Times are of the CPU, medians over the frames of the drag but the first ones, in which what stays is found; "quiet" is
the fastest tenth of them, which other programs have disturbed least. Sizes are those in which marks go to the page.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from time import thread_time

import numpy as np

import restshape
from restshape.application import application_of
from restshape.interface.simulation import Simulation
from restshape.live.frame_arrays import MessageBody
from restshape.live.mark_messages import placed

APPS = Path(__file__).parents[1] / "apps"
FRAMES, FIRST = 60, 5
Drag = Callable[[Simulation], Iterator[object]]


def dragged(on: str, start: tuple[float, ...], way: tuple[float, ...]) -> Drag:
    """A drag of an entity, straight on from a place [m] by a way in each frame [m]."""

    def drag(simulation: Simulation) -> Iterator[object]:
        simulation.do("press", on=on, at=list(start))
        for k in range(1, FRAMES + 1):
            yield simulation.do("drag", to=[x + k * d for x, d in zip(start, way)])

    return drag


def lengthened(simulation: Simulation) -> Iterator[object]:
    """A leg that becomes longer, whose range is shown."""
    simulation.do("press", on="leg-4", parameter="length y")
    for k in range(1, FRAMES + 1):
        yield simulation.do("drag", by=0.001 * k)


TABLE, FISH = "furniture/scenes/table.toml", "metallophone/scenes/fish.toml"
DRAGS: dict[str, tuple[str, tuple[str, ...], Drag]] = {
    "plate": ("solid/scenes/plate.toml", (), dragged("window", (0.5, 0.5), (1e-3, 0.0))),
    "bridge": ("bridge/scenes/bridge.toml", (), dragged("underside", (10.0, 1.6), (0.0, 2e-3))),
    "cantilever": ("cantilever/scenes/cantilever.toml", (), dragged("b", (2.0, 0.0), (0.0, 2e-4))),
    "column that buckles": ("solid/scenes/euler.toml", (), dragged("c", (0.02, 1.0), (5e-5, 0.0))),
    "fins": ("thermal/scenes/fins.toml", (), dragged("u", (0.054, 0.038), (0.0, 1e-4))),
    "steady flow": ("flow/scenes/steady_flow.toml", (), dragged("tail", (0.06, 0.0), (0.0, -5e-5))),
    "building": ("vibration/scenes/building.toml", (), dragged("right_top", (5.7, 16.6), (0.0, -2e-3))),
    "table, a plank": (TABLE, (), dragged("leg-4", (0.325, 0.2, 0.35), (0.0, 5e-4, 0.0))),
    "table, a length": (TABLE, (), lengthened),
    "fish, a plate": (
        FISH,
        ("effects.modal.model='plate'", "mesh.order=1"),
        dragged("fork", (0.13, 0.0), (-1e-4, 0.0)),
    ),
    "cloth on pins": ("couture/scenes/pins.toml", (), dragged("b", (0.5, 0.0), (5e-4, 0.0))),
}


def costs(scene: str, overrides: tuple[str, ...], drag: Drag) -> dict[str, float]:
    """The times [ms] of frames and of their marks, and the bytes of these."""
    frames, marks, sizes = [], [], []
    with restshape.open(restshape.load(APPS / scene, *overrides), strict=False) as simulation:
        application, begin = application_of(simulation.scene), thread_time()
        for _ in drag(simulation):
            assert not simulation.frame.refused, simulation.frame.refused
            # The page has the fields, whatever is marked.
            _ = simulation.frame.fields
            middle = thread_time()
            found = application.marked(simulation)
            end = thread_time()
            body = MessageBody()
            said = json.dumps([placed(one, body) for one in found])
            frames.append(middle - begin)
            marks.append(end - middle)
            sizes.append(len(said) + body.size)
            begin = thread_time()
    ms, own = (1e3 * np.array(one[FIRST:]) for one in (frames, marks))
    return {
        "frame_ms": float(np.median(ms)),
        "marks_ms": float(np.median(own)),
        "marks_quiet_ms": float(np.percentile(own, 10)),
        "bytes": float(np.median(sizes)),
    }


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="for programs")
    as_json = parser.parse_args().json
    found = {name: costs(*one) for name, one in DRAGS.items()}
    if as_json:
        print(json.dumps(found, indent=1))
        return
    print(f"{'drag':20}{'frame [ms]':>11}{'marks [ms]':>11}{'quiet':>7}{'kB':>7}")
    for name, one in found.items():
        frame, marks, quiet, size = one.values()
        print(f"{name:20}{frame:11.2f}{marks:11.3f}{quiet:7.3f}{1e-3 * size:7.1f}")


if __name__ == "__main__":
    main()
