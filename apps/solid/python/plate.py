"""The window of a plate goes to a side, and the plate gets thinner: stresses and where the largest one is.

python apps/solid/python/plate.py
"""

from pathlib import Path

import restshape

SCENE = Path(__file__).parents[1] / "scenes" / "plate.toml"


def edit(sim: restshape.Simulation) -> None:
    """Drags the window, and prints where the stress is largest."""
    with sim.press("window", at=[0.5, 0.5]) as hand:
        places = [[0.5 + 0.005 * step, 0.5] for step in range(1, 5)]
        for (x, _), frame in zip(places, hand.along(places)):
            print(f"hand at {x:.3f} m: {frame.quantities['peak_stress']:.4g} Pa")
    frame = sim.set("material.steel.thickness", "8 mm")
    print("largest stress at", frame.mesh.points[frame.von_mises.argmax()].round(3))


if __name__ == "__main__":
    with restshape.open(restshape.load(SCENE)) as simulation:
        edit(simulation)
        print(simulation.script.text)
