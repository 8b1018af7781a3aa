"""The underside of a bridge is pulled up: less area, more stress.

python apps/bridge/python/underside.py
"""

from pathlib import Path

import restshape

SCENE = Path(__file__).parents[1] / "scenes" / "bridge.toml"


def edit(sim: restshape.Simulation) -> None:
    """Pulls the underside between pins, makes a window, and takes that back."""
    with sim.pull("underside", at=[10.0, 1.6], pins=[[2.5, 1.2], [17.5, 1.2]]) as hand:
        frame = hand.to(10.0, 1.75, frames=3)
    print(f"area {frame.quantities['score']:.3f} m^2, stress {frame.quantities['strength']:.4g} Pa")
    frame = sim.hole("left_window", center=[5.0, 2.3], radius=0.25)
    print(f"with a window {frame.quantities['strength']:.4g} Pa")
    sim.undo()


if __name__ == "__main__":
    with restshape.open(restshape.load(SCENE)) as simulation:
        edit(simulation)
        print(simulation.script.text)
