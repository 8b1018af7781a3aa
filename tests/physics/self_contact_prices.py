"""What the search for meetings of cloth with itself costs, beside IPC Toolkit's.

python tests/physics/self_contact_prices.py

A sheet of 8,978 triangles that is flat, or in waves, and steps of one length in random directions, smooth along it:
milliseconds of the broad phase and of the share of the step, the least of five.
"""

from functools import partial
from time import process_time

import numpy as np
from test_cloth_crossings import grid

from restshape import _kernels
from restshape.physics.cloth.contact.collision_surface import CollisionSurface, columns


def least(function, times=5):
    """The least time [ms] of a call, and what it gives."""
    spent = []
    for _ in range(times):
        start = process_time()
        found = function()
        spent.append(process_time() - start)
    return 1e3 * min(spent), found


def main() -> None:
    """Print the table."""
    X, cells = grid(67)
    surface = CollisionSurface(X, cells)
    own = _kernels.NearPairs(X, surface.edges, surface.cells)
    library, random = surface.library, np.random.default_rng(0)
    print("cloth  step/edge  own [ms]  IPC Toolkit [ms]  share  its share")
    for name, height in (("flat", 0.0), ("waves", 0.1)):
        x = np.column_stack([X, height * np.sin(40.0 * X[:, 0]) + 0.01 * height * random.normal(size=len(X))])
        for part in (0.01, 0.3, 3.0):
            waves = random.normal(size=(3, 2, 4)) * 10.0
            d = np.column_stack([np.sin(X @ wave).sum(axis=1) for wave in waves])
            d *= part / 67.0 / np.abs(d).max()

            def toolkit(x=x, d=d):
                found = library.Candidates()
                ends = columns(x), columns(x + d)
                found.build(surface.mesh, *ends, 0.0, library.LBVH())
                return found.compute_collision_free_stepsize(surface.mesh, *ends, 0.0, library.AdditiveCCD())

            (mine, share), (theirs, known) = least(partial(own.step_share, x, d)), least(toolkit)
            print(f"{name:6} {part:9.2f} {mine:9.1f} {theirs:17.1f} {share:6.3f} {known:10.3f}")


if __name__ == "__main__":
    main()
