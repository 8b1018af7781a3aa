"""The tail of a body in a flow goes down: drag and lift.

python apps/flow/python/tail.py
"""

from pathlib import Path

import restshape

SCENE = Path(__file__).parents[1] / "scenes" / "steady_flow.toml"


def edit(sim: restshape.Simulation) -> None:
    """Drags the tail down."""
    with sim.press("tail", at=["60 mm", 0]) as hand:
        frame = hand.to("60 mm", "-1 mm", frames=3)
    print({name: f"{value:.4g}" for name, value in frame.quantities.items()})


if __name__ == "__main__":
    with restshape.open(restshape.load(SCENE)) as simulation:
        edit(simulation)
        print(simulation.script.text)
