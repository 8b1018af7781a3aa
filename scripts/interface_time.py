"""Prints what a frame costs a program that holds the hand, beside the same frame of a replay.

python scripts/interface_time.py [SCENE] [ENTITY]
"""

import argparse
from pathlib import Path
from time import perf_counter

import numpy as np

import restshape

PLATE = Path(__file__).parents[1] / "apps" / "solid" / "scenes" / "plate.toml"
FRAMES = 300


def main() -> None:
    """Drags an entity in 300 frames, and replays what that was."""
    parser = argparse.ArgumentParser(description="Prints what a frame costs a program that holds the hand.")
    parser.add_argument("scene", nargs="?", type=Path, default=PLATE, help="scene (default: the plate)")
    parser.add_argument("entity", nargs="?", default="window", help="what the hand holds (default: window)")
    args = parser.parse_args()
    scene = restshape.load(args.scene)
    by_hand, script = dragged(scene, args.entity)
    beside = replayed(scene, script)
    for name, times in (("hand.to", by_hand), ("replay", beside), ("difference", by_hand - beside)):
        print(f"{name:10} {1e6 * np.median(times):8.1f} us (p50 of {len(times)} frames)")


def dragged(scene: restshape.Scene, entity: str) -> tuple[np.ndarray, restshape.Script]:
    """Seconds (n,) beside those of the frame loop that each `hand.to` takes, and the script of it."""
    seconds = []
    with restshape.open(scene, strict=False) as sim:
        with sim.press(entity, at=[0.0, 0.0]) as hand:
            for x in np.linspace(0.0, 0.05, FRAMES):
                start = perf_counter()
                frame = hand.to(x, 0.0)
                seconds.append(perf_counter() - start - 1e-3 * frame.row["ms"])
        return np.array(seconds), sim.script


def replayed(scene: restshape.Scene, script: restshape.Script) -> np.ndarray:
    """The same (n,) of the frames of a replay that are drags."""
    seconds, start = [], perf_counter()
    for frame in restshape.replay(scene, script):
        now = perf_counter()
        if frame.row["event"] == "drag":
            seconds.append(now - start - 1e-3 * frame.row["ms"])
        start = perf_counter()
    return np.array(seconds)


if __name__ == "__main__":
    main()
