"""Writes the sample body of this folder: python meshes/write_bodies.py.

stool.obj: a round seat on a conical foot, in centimetres, z upwards: 40 cm wide and 45 cm high, its edges rounded. The
profile is turned about z; chords of a circle are 0.1 mm deep.
"""

from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parent
AROUND, ACROSS = 96, 9


def arc(x: float, z: float, radius: float, first: float, last: float) -> np.ndarray:
    """Points (n, 2) of a profile on an arc about a point, between two angles [degrees]."""
    angle = np.deg2rad(np.linspace(first, last, ACROSS))
    return np.column_stack([x + radius * np.cos(angle), z + radius * np.sin(angle)])


def profile() -> np.ndarray:
    """Radius and height [cm] from the middle of the floor to that of the seat, without these."""
    foot, top = arc(12.0, 1.5, 1.5, -90.0, 10.0), arc(16.5, 41.5, 3.5, 0.0, 90.0)
    under = arc(17.5, 40.5, 2.5, -90.0, 0.0)[:-1]
    # Between neck and seat the surface is hollow.
    neck = arc(11.0, 34.0, 4.0, 180.0, 90.0)
    return np.vstack([[[6.0, 0.0]], foot, neck, under, top, [[12.0, 45.0], [6.0, 45.0]]])


def main() -> None:
    """Writes the body."""
    rings = profile()
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    lines = ["# A stool in centimetres, written by meshes/write_bodies.py", "v 0 0 0", "v 0 0 45"]
    lines += [f"v {r * np.cos(a):.4f} {r * np.sin(a):.4f} {z:.4f}" for r, z in rings for a in angle]
    count = len(rings)
    for k in range(AROUND):
        right = (k + 1) % AROUND
        lines.append(f"f 1 {3 + right} {3 + k}")
        for i in range(count - 1):
            low, high = 3 + i * AROUND, 3 + (i + 1) * AROUND
            lines.append(f"f {low + k} {low + right} {high + right} {high + k}")
        last = 3 + (count - 1) * AROUND
        lines.append(f"f 2 {last + k} {last + right}")
    (FOLDER / "stool.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
