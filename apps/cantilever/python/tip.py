"""The tip of a cantilever goes up, and what bends far is solved in steps.

python apps/cantilever/python/tip.py
"""

from pathlib import Path

import restshape

SCENE = Path(__file__).parents[1] / "scenes" / "cantilever.toml"


def edit(sim: restshape.Simulation) -> None:
    """Drags the tip up and lets go."""
    with sim.press("tip", at=[2.0, 0.125]) as hand:
        frame = hand.to(2.0, 0.16, frames=3)
    print({name: round(value, 4) for name, value in frame.quantities.items()}, frame.row["newton"], "steps")


if __name__ == "__main__":
    with restshape.open(restshape.load(SCENE)) as simulation:
        edit(simulation)
        print(simulation.script.text)
