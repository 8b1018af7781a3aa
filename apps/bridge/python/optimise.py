"""The least area of a bridge whose stress stays below its limit, over two parameters, by scipy.optimize.

The bridge of scenes/bridge.toml gets two windows and two parameters: how far its underside rises, and the radius of
the windows. The score and the stress, and their derivatives, are those of frames.

python apps/bridge/python/optimise.py
"""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize

import restshape

SCENE = Path(__file__).parents[1] / "scenes" / "bridge.toml"
SCRIPT = Path(__file__).parents[1] / "edits" / "bridge.jsonl"
NAMES = ("rise", "window")
START, BOUNDS = (0.1, 0.3), ((0.0, 0.3), (0.15, 0.45))
"""Of the rise, a share, and the radius [m]."""
SPARE = 2e-3
"""Share of the limit that is kept free: flips and new meshes change stresses by about as much."""
WINDOWS = {"left_window": (3.4, 2.35), "right_window": (16.6, 2.35)}
"""Their middles [m]: about where the scripted designer leaves them."""


def with_parameters(scene: restshape.Scene) -> restshape.Scene:
    """The bridge with windows and parameters; the spline keeps its knots, so that its points alone move."""
    tables: dict[str, Any] = dict(scene.raw)
    shape = tables["shape"]
    inner = shape["edges"]["underside"]["through"]
    points = np.array([shape["vertices"]["s"], *inner, shape["vertices"]["t"]], dtype=float)
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    underside = {
        "spline": ["s", "t"],
        "through": [[x, f"{y} * (1 + rise)"] for x, y in inner],
        "knots": along[1:-1] / along[-1],
    }
    holes = {name: {"circle": {"center": middle, "radius": "window"}} for name, middle in WINDOWS.items()}
    tables["shape"] = shape | {"edges": shape["edges"] | {"underside": underside}, "holes": holes}
    tables["parameters"] = dict(zip(NAMES, START))
    return restshape.new_scene(tables, SCENE)


class Design:
    """What the optimiser asks of a design: each one is set in the same simulation, whose mesh follows.

    Args:
        sim: of the bridge with parameters.

    Attributes:
        limit: of the stress [Pa]; count: of designs.
    """

    def __init__(self, sim: restshape.Simulation) -> None:
        self._sim, self._known = sim, dict[bytes, tuple[dict[str, float], dict[str, np.ndarray]]]()
        self.limit = float(sim.scene.quantities["strength"].max)
        self.count = 0

    def score(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """Area [m^2], and its derivatives (2,)."""
        values, slopes = self._at(x)
        return values["score"], slopes["score"]

    def room(self, x: np.ndarray) -> float:
        """What the stress leaves of its limit but for `SPARE`, as a share."""
        return 1.0 - SPARE - self._at(x)[0]["strength"] / self.limit

    def room_slopes(self, x: np.ndarray) -> np.ndarray:
        """Derivatives (2,) of `room`."""
        return -self._at(x)[1]["strength"] / self.limit

    def best(self) -> tuple[np.ndarray, dict[str, float]]:
        """The design of least area, of those that hold, and its quantities."""
        valid = [(key, values) for key, (values, _) in self._known.items() if values["strength"] <= self.limit]
        key, values = min(valid, key=lambda one: one[1]["score"])
        return np.frombuffer(key), values

    def _at(self, x: np.ndarray) -> tuple[dict[str, float], dict[str, np.ndarray]]:
        """Quantities of a design, and their derivatives (2,)."""
        key = x.tobytes()
        if key not in self._known:
            for name, value in zip(NAMES, x):
                frame = self._sim.set(f"parameters.{name}", float(value))
            by = [frame.derivative(f"parameters.{name}") for name in NAMES]
            slopes = {name: np.array([one[name] for one in by]) for name in by[0]}
            self._known[key] = frame.quantities, slopes
            self.count += 1
        return self._known[key]


def optimised(sim: restshape.Simulation) -> tuple[np.ndarray, dict[str, float], Design]:
    """The design (2,) of least area that was seen to hold, from `START` on, its quantities, and what was asked."""
    design = Design(sim)
    room = {"type": "ineq", "fun": design.room, "jac": design.room_slopes}
    options = {"maxiter": 12, "ftol": 1e-3}
    minimize(design.score, START, jac=True, method="SLSQP", bounds=BOUNDS, constraints=[room], options=options)
    return *design.best(), design


def designer(scene: restshape.Scene) -> float:
    """The least area [m^2] of the frames of the scripted designer that hold, on the same mesh size."""
    script = restshape.load_script(SCRIPT, scene)
    rows = [frame.quantities for frame in restshape.replay(scene, script)]
    limit = float(scene.quantities["strength"].max)
    return min(row["score"] for row in rows if row["strength"] <= limit)


def main() -> None:
    """Prints what was found beside what the designer has."""
    scene = restshape.load(SCENE)
    with restshape.open(with_parameters(scene)) as sim:
        x, best, design = optimised(sim)
    print(f"rise {x[0]:.4f}, windows of {x[1]:.4f} m, the best of {design.count} designs")
    print(f"area {best['score']:.3f} m^2, stress {best['strength'] / 1e6:.3f} MPa")
    print(f"the scripted designer: {designer(scene):.3f} m^2")


if __name__ == "__main__":
    main()
