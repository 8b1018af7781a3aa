"""A column of a frame is drawn outwards while the ground shakes.

python apps/vibration/python/frame.py
"""

from pathlib import Path

import restshape

SCENE = Path(__file__).parents[1] / "scenes" / "frame.toml"


def edit(sim: restshape.Simulation) -> None:
    """Lets time go on, drags the column, and lets time go on."""
    sim.idle(2)
    with sim.press("right", at=[6.4, 5.0]) as hand:
        hand.to(6.45, 5.0, frames=3)
    frame = sim.idle(2)
    print(f"{frame.row['time']:.2f} s:", {name: f"{value:.4g}" for name, value in frame.quantities.items()})


if __name__ == "__main__":
    with restshape.open(restshape.load(SCENE)) as simulation:
        edit(simulation)
        print(simulation.script.text)
