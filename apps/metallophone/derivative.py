"""How the tones of a plate follow its numbers and its outline.

python -m restshape_apps.metallophone.derivative SCENE [--edits FILE] [--by KEY ...] [--outline] [--json FILE]
"""

import argparse
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from restshape_apps.metallophone.stage import add_scene, analysed

from restshape.analysis.modal import ModalAnalysis
from restshape.cli.options import print_table, refuse_overwriting, write_json
from restshape.errors import UserError
from restshape.outputs.kinds import JsonFile
from restshape.sensitivity.frequency_derivative import stands_alone
from restshape.sensitivity.outline_density import edge_densities, outline_density
from restshape.sensitivity.parameter_derivative import number_at, parameter_derivatives


def keys_of(analysis: ModalAnalysis) -> list[str]:
    """The numbers that every such scene has: of each material those that are no formula, and all parameters."""
    keys = []
    for name, material in analysis.state.scene.material.items():
        own = ["rho"] if material.E is None else ["E", "nu", "rho"]
        own += ["thickness"] if isinstance(material.thickness, int | float) else []
        keys += [f"material.{name}.{key}" for key in own]
    return keys + [f"parameters.{name}" for name in analysis.state.scene.parameters]


def along_outline(analysis: ModalAnalysis) -> list[dict[str, Any]]:
    """Of each mode that stands alone, edge by edge: places [m] and the density [Hz/m^2] there."""
    found = []
    for rank, mode in enumerate(analysis.state.modes.chosen, 1):
        if not stands_alone(analysis, int(mode)):
            continue
        edges = {
            name: {
                "at": own.at.tolist(),
                "normal": own.normal.tolist(),
                "length": own.length.tolist(),
                "density": own.density.tolist(),
            }
            for name, own in edge_densities(analysis, outline_density(analysis, int(mode))).items()
        }
        found.append({"mode": rank, "frequency": float(analysis.frequencies[rank - 1]), "edges": edges})
    return found


def main(words: Sequence[str] | None = None) -> int:
    """Print, and write for programs; 0 on success, 2 on bad input."""
    parser = argparse.ArgumentParser(prog="python -m restshape_apps.metallophone.derivative", description=__doc__)
    add_scene(parser)
    parser.add_argument("--by", action="append", default=[], metavar="KEY", help="a number of the scene (default: all)")
    parser.add_argument("--outline", action="store_true", help="also by the outline, as a density along each edge")
    parser.add_argument("--json", type=JsonFile, metavar="FILE", help="the same for programs")
    args = parser.parse_args(words)
    try:
        refuse_overwriting(args)
        analysis = analysed(args)
        keys = args.by or keys_of(analysis)
        by = {key: (number_at(analysis, key), parameter_derivatives(analysis, key)) for key in keys}
    except UserError as error:
        print(f"derivative: {error}", file=sys.stderr)
        return 2
    frequencies = analysis.frequencies
    heads = ("p", "value (SI)", *(f"mode {k}: {f:.1f} Hz" for k, f in enumerate(frequencies, 1)))
    rows = [
        (key, f"{p:.6g}", *(f"{p * d / f:+.5f}" for d, f in zip(found, frequencies))) for key, (p, found) in by.items()
    ]
    print_table("relative derivatives: p df/dp / f", heads, rows, right=heads[1:])
    derivatives_found: dict[str, Any] = {
        "frequencies": frequencies.tolist(),
        "by": {key: {"value": p, "derivatives": found.tolist()} for key, (p, found) in by.items()},
    }
    if args.outline:
        derivatives_found["outline"] = along_outline(analysis)
        print_outline(derivatives_found["outline"])
    write_json(args, derivatives_found)
    return 0


def print_outline(found: list[dict[str, Any]]) -> None:
    """Print by how much each edge changes each tone if a tenth of a millimetre is rasped off all along it."""
    heads = ("0.1 mm off edge", *(f"mode {entry['mode']}: [Hz]" for entry in found))
    edges = list(dict.fromkeys(edge for entry in found for edge in entry["edges"]))
    rows = [(edge, *(f"{_rasped(entry['edges'].get(edge)):+.2f}" for entry in found)) for edge in edges]
    print_table("", heads, rows, right=heads[1:])


def _rasped(edge: dict[str, Any] | None, depth: float = 1e-4) -> float:
    """The change [Hz] by a depth [m] off an edge."""
    return -depth * float(np.dot(edge["density"], edge["length"])) if edge else 0.0


if __name__ == "__main__":
    sys.exit(main())
