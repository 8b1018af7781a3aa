"""Scenes of tines on a root, which hardly anything couples."""

from pathlib import Path


def kalimba(folder: Path, lengths: list[float], width: float = 0.006, gap: float = 0.003, root: float = 0.004) -> Path:
    """A scene of tines [m] side by side on one root, which is held up to their feet: hardly anything couples them."""
    tines = [(k * (width + gap), root + length) for k, length in enumerate(lengths)]
    points = [(0.0, 0.0), (tines[-1][0] + width, 0.0)]
    for x, top in reversed(tines):
        points += [(x + width, root), (x + width, top), (x, top), (x, root)]
    ends = list(zip(points, [*points[1:], points[0]]))
    supported = [f'"e{i}"' for i, (p, q) in enumerate(ends) if max(p[1], q[1]) <= root]
    path = folder / "kalimba.toml"
    path.write_text(
        'format = "restshape-scene"\nversion = 1\napp = "metallophone"\n[shape]\noutline = ['
        + ", ".join(f'"e{i}"' for i in range(len(points)))
        + "]\n[shape.vertices]\n"
        + "".join(f"p{i} = [{x}, {y}]\n" for i, (x, y) in enumerate(points))
        + "[shape.edges]\n"
        + "".join(f'e{i} = {{ line = ["p{i}", "p{(i + 1) % len(points)}"] }}\n' for i in range(len(points)))
        + '[material.steel]\nE = "200 GPa"\nnu = 0.3\nrho = "8000 kg/m^3"\nthickness = "1 mm"\n'
        + '[effects.modal]\nmodel = "plate"\nmodes = 1\n'
        + f'[supports.root]\non = [{", ".join(supported)}]\nfix = ["z", "rx", "ry"]\n'
        + '[mesh]\nsize = "3 mm"\n[solve]\ntolerance = 1e-3\n[quantities]\nfirst = { frequency = 1 }\n'
    )
    return path
