"""A strip that hangs between two pins gets longer: how far down it comes.

python apps/couture/python/longer.py
"""

from pathlib import Path

import restshape

SCENE = Path(__file__).parents[1] / "scenes" / "longer.toml"


def edit(sim: restshape.Simulation) -> None:
    """Drags the right side of the pattern out, and lets the cloth come to rest."""
    with sim.press("right", at=[0.5, 0.1]) as hand:
        hand.to(0.52, 0.1, frames=4)
    frame = sim.idle(2)
    print(f"the lowest point is at {(frame.displacement[:, 2]).min():.4f} m")


if __name__ == "__main__":
    with restshape.open(restshape.load(SCENE)) as simulation:
        edit(simulation)
        print(simulation.script.text)
