"""The fork of a fish goes in, and its tones change.

python apps/metallophone/python/fish.py
"""

from pathlib import Path

import restshape

SCENE = Path(__file__).parents[1] / "scenes" / "fish.toml"


def edit(sim: restshape.Simulation) -> None:
    """Drags the fork of the tail, and prints the first tone."""
    with sim.press("fork", at=[0.13, 0.0]) as hand:
        frame = hand.to(0.127, 0.0, frames=3)
    print({name: f"{value:.6g}" for name, value in frame.quantities.items()})


if __name__ == "__main__":
    with restshape.open(restshape.load(SCENE)) as simulation:
        edit(simulation)
        print(simulation.script.text)
