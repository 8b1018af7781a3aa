"""A leg of a table goes outwards; suggestions that make it valid again are taken.

python apps/furniture/python/table.py
"""

from pathlib import Path

import restshape

SCENE = Path(__file__).parents[1] / "scenes" / "table.toml"


def edit(sim: restshape.Simulation) -> None:
    """Drags a leg, takes a suggestion, slides along it, and takes both back."""
    with sim.press("leg-4", at=[0.325, 0.2, 0.35]) as hand:
        frame = hand.to(0.325, 0.32, 0.35, frames=2)
    print({finding.kind: finding.subjects for finding in frame.findings})
    sim.do("choose", number=1)
    sim.do("slide", to=0.5, frames=2)
    sim.undo()
    frame = sim.undo()
    print(frame)


if __name__ == "__main__":
    with restshape.open(restshape.load(SCENE)) as simulation:
        edit(simulation)
        print(simulation.script.text)
