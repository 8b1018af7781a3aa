"""Two ways of a frame to the screen, in CPU time and bytes: its arrays, or a picture that VTK has drawn of them.

python scripts/ways_to_screen.py [SCENE] [--size LENGTH]

The first is that of `restshape live`: the browser draws. The second is that of servers that send pictures, such as
trame's remote view: VTK draws without a window and encodes a JPEG; what the browser needs to decode it is left out.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from time import process_time

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

import restshape
from restshape.interface.simulation import Simulation
from restshape.live.frame_message import FrameEncoder
from restshape.live.frame_picture import FramePicture

PLATE = Path(__file__).parents[1] / "apps" / "solid" / "scenes" / "plate.toml"
SIZE = (940, 760)
"""Pixels of the canvas of a page of 1280 x 800."""
FRAMES = 40


class VtkPicture:
    """Draws the deformed shape in the colours of a field.

    Args:
        sim: whose frames are drawn.
    """

    def __init__(self, sim: Simulation) -> None:
        self._sim = sim
        self._grid, self._window = vtk.vtkPolyData(), vtk.vtkRenderWindow()
        mapper, self._actor, renderer = vtk.vtkPolyDataMapper(), vtk.vtkActor(), vtk.vtkRenderer()
        mapper.SetInputData(self._grid)
        self._actor.SetMapper(mapper)
        self._actor.GetProperty().EdgeVisibilityOn()
        self._mapper, self._renderer = mapper, renderer
        renderer.AddActor(self._actor)
        self._window.SetOffScreenRendering(1)
        self._window.SetSize(*SIZE)
        self._window.AddRenderer(renderer)

    def __call__(self) -> bytes:
        """A JPEG of the last frame."""
        frame = self._sim.frame
        points = np.zeros((len(frame.mesh.points), 3))
        points[:, :2] = frame.mesh.points + 100.0 * frame.displacement
        cells = frame.mesh.cells.astype(np.int64)
        polygons, nodes = vtk.vtkCellArray(), vtk.vtkPoints()
        polygons.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(cells).ravel(), deep=True))
        nodes.SetData(numpy_to_vtk(points, deep=True))
        self._grid.SetPoints(nodes)
        self._grid.SetPolys(polygons)
        self._grid.GetPointData().SetScalars(numpy_to_vtk(frame.von_mises, deep=True))
        self._mapper.SetScalarRange(0.0, float(frame.von_mises.max()))
        self._window.Render()
        source, writer = vtk.vtkWindowToImageFilter(), vtk.vtkJPEGWriter()
        source.SetInput(self._window)
        source.ReadFrontBufferOff()
        writer.SetInputConnection(source.GetOutputPort())
        writer.WriteToMemoryOn()
        writer.Write()
        return bytes(memoryview(writer.GetResult()))


class ArrayMessage:
    """The message of a frame, as `restshape live` sends it.

    Args:
        sim: whose frames are sent.
    """

    def __init__(self, sim: Simulation) -> None:
        self._picture, self._encoder = FramePicture(sim), FrameEncoder()

    def __call__(self) -> bytes:
        """The message of the last frame."""
        return b"".join(bytes(piece) for piece in self._encoder({}, self._picture.parts()))


def main() -> None:
    """Drags the hole of a plate, and prints what each way takes of each frame."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", type=Path, default=PLATE, help="of a solid (default: the plate)")
    parser.add_argument("--size", help="of the mesh, such as 8mm")
    args = parser.parse_args()
    scene = restshape.load(args.scene, *([f"mesh.size='{args.size}'"] if args.size else []))
    with restshape.open(scene) as sim, sim.press("window", at=[0.0, 0.0]) as hand:
        ways: dict[str, Callable[[], bytes]] = {"arrays": ArrayMessage(sim), "picture": VtkPicture(sim)}
        found: dict[str, list[tuple[float, int]]] = {name: [] for name in ways}
        for k in range(1, FRAMES + 1):
            hand.to(2e-3 * k, 0.0)
            for name, way in ways.items():
                start = process_time()
                size = len(way())
                found[name].append((process_time() - start, size))
        print(f"{len(sim.frame.mesh.cells)} triangles, {SIZE[0]} x {SIZE[1]} pixels, medians of {FRAMES} frames")
    for name, all_of in found.items():
        seconds, size = np.median(all_of[5:], axis=0)
        print(f"{name:8} {1e3 * seconds:8.2f} ms of the CPU in the server {size / 1e3:8.1f} kB")


if __name__ == "__main__":
    main()
