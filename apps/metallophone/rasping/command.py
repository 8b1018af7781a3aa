"""`restshape tune --rasp`: where to rasp a bar that has been measured, and how much."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from restshape.errors import UserError

if TYPE_CHECKING:
    from restshape.scene.model import Scene


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--measured", type=float, metavar="HZ", help="measured frequency of the first tone [Hz]")
    parser.add_argument("--rasp", action="store_true", help="say where to rasp, and how much")


def run(scene: Scene, args: argparse.Namespace) -> int:
    """Print the advice; 0."""
    raise UserError(f"no advice for {scene.path.name}", "--rasp", f"tune to {args.to} without it")
