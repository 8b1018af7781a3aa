"""A fin of a heat sink grows, and then the fan fails.

python apps/thermal/python/fins.py
"""

from pathlib import Path

import restshape

SCENE = Path(__file__).parents[1] / "scenes" / "fins.toml"


def edit(sim: restshape.Simulation) -> None:
    """Makes a fin longer, and the air stand still."""
    with sim.press("tip2", at=["30 mm", "38 mm"]) as hand:
        hand.to("30 mm", "40 mm", frames=2)
    frame = sim.set("loads.air.convection.film", "8 W/(m^2 K)")
    print({name: f"{value:.4g}" for name, value in frame.quantities.items()})


if __name__ == "__main__":
    with restshape.open(restshape.load(SCENE)) as simulation:
        edit(simulation)
        print(simulation.script.text)
