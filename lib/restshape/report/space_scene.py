"""Shapes in space as pictures: VTK draws them off screen, at true scale, the same pixels each time."""

from __future__ import annotations

from collections.abc import Iterator
from ctypes import CDLL
from functools import cache
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_rgb
from scipy.ndimage import binary_erosion
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPlane, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals, vtkTubeFilter
from vtkmodules.vtkFiltersSources import vtkConeSource
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkCamera,
    vtkLight,
    vtkMapper,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingOpenGL2 import vtkEGLRenderWindow

from restshape.errors import UserError
from restshape.report.camera import Camera, Window

FINER = 2
"""Pixels that are drawn for each one shown, along both axes."""
LIGHT = (-0.2, 0.55, 0.81)
"""Where light comes from, as the camera sees it: left, up, near."""
AMBIENT = 0.55
"""Light that comes from everywhere."""
SIDES = 24
"""Of tubes and cones."""
HEAD = 8.0
"""Length of an arrow's head over the radius of its shaft."""
DASH, PALE = 2.4, 0.6
"""Of an outline that is hidden: length of dashes and of the gaps between them [points], and how much darkens there."""
SOLID, GHOST, HALO, MARK, TOP = range(5)
"""Layers, each drawn over those before it; within one, what is nearer hides what is farther."""


class SpaceDrawing:
    """Surfaces, lines, tubes and arrows in space.

    Args:
        joined: scenes whose parts it shows, too.
    """

    def __init__(self, *joined: SpaceDrawing) -> None:
        self._parts: list[tuple[vtkActor, int, float]] = [part for scene in joined for part in scene._parts]

    @property
    def empty(self) -> bool:
        """Whether there is nothing to see."""
        return not self._parts

    def surface(
        self,
        places: np.ndarray,
        faces: np.ndarray,
        colours: Any,
        edges: tuple[str, float] | None = None,
        smooth: float | None = None,
        within: tuple[np.ndarray, np.ndarray] | None = None,
        layer: int = SOLID,
        at_places: bool = False,
    ) -> None:
        """Add a surface, which is lit.

        Args:
            places: (n, 3) [m].
            faces: (m, k) corners, in order around each.
            colours: of all, or (m, 3) of each face, from 0 to 1.
            edges: colour and width [points] of the sides of all faces.
            smooth: lit as a curved surface, but for edges sharper than this angle [degrees]; None: as flat faces.
            within: corners (3,) of a box beyond which it is cut off [m].
            layer: SOLID, GHOST, HALO, MARK or TOP.
            at_places: colours are (n, 3), of each place, and blend in between.
        """
        if not len(faces):
            return
        data = _coloured(_poly_data(places, faces=faces), colours, at_places)
        actor = _actor(data if smooth is None else _smoothed(data, smooth), colours)
        look = actor.GetProperty()
        look.SetAmbient(AMBIENT)
        look.SetDiffuse(1.0 - AMBIENT)
        look.LightingOn()
        if smooth is None:
            look.SetInterpolationToFlat()
        if edges:
            look.EdgeVisibilityOn()
            look.SetEdgeColor(*to_rgb(edges[0]))
        for plane in _sides_of(*within) if within else ():
            actor.GetMapper().AddClippingPlane(plane)
        self._parts.append((actor, layer, edges[1] if edges else 1.0))

    def lines(self, ends: np.ndarray, colour: str, width: float, layer: int = SOLID) -> None:
        """Add straight lines (n, 2, 3) [m] of a width [points]."""
        if len(ends):
            self._parts.append((_actor(_line_data(ends), colour), layer, width))

    def tubes(self, ends: np.ndarray, colours: Any, radius: float, layer: int = MARK) -> None:
        """Add straight tubes (n, 2, 3) of a radius [m], of one colour or of colours (n, 3)."""
        if not len(ends):
            return
        tube = vtkTubeFilter()
        tube.SetInputData(_coloured(_line_data(ends), colours))
        tube.SetRadius(radius)
        tube.SetNumberOfSides(SIDES)
        tube.CappingOn()
        tube.Update()
        self._parts.append((_actor(tube.GetOutput(), colours), layer, 1.0))

    def arrow(self, start: np.ndarray, end: np.ndarray, colour: str, radius: float, layer: int = TOP) -> None:
        """Add an arrow from a place to another one [m]: a tube of this radius, and a head three times as wide."""
        length = float(np.linalg.norm(end - start))
        head, along = min(HEAD * radius, 0.7 * length), (end - start) / length
        cone = vtkConeSource()
        cone.SetResolution(SIDES)
        cone.SetHeight(head)
        cone.SetRadius(3.0 / HEAD * head)
        cone.SetDirection(*along)
        cone.SetCenter(*(end - 0.5 * head * along))
        cone.Update()
        self._parts.append((_actor(cone.GetOutput(), colour), layer, 1.0))
        self.tubes(np.array([[start, end - 0.9 * head * along]]), colour, min(radius, head / HEAD), layer)

    def pixels(self, camera: Camera, window: Window, columns: int, rows: int, point: float = 1.0) -> np.ndarray:
        """Red, green and blue (rows, columns, 3) from 0 to 1, on white; the first row is the lowest.

        Args:
            camera: looks at the scene.
            window: that is shown.
            columns, rows: of pixels.
            point: pixels of a point, the unit of the widths of lines.

        Raises:
            UserError: this machine has no OpenGL off screen.
        """
        screen = _screen()
        screen.SetSize(FINER * columns, FINER * rows)
        layers = [_renderer(layer) for layer in range(TOP + 1)]
        for actor, layer, width in self._parts:
            actor.GetProperty().SetLineWidth(FINER * point * width)
            layers[layer].AddActor(actor)
        reach = max(_reach(actor, camera) for actor, *_ in self._parts) if self._parts else 0.0
        for renderer in layers:
            renderer.SetActiveCamera(_vtk_camera(camera, window, reach))
            renderer.ResetCameraClippingRange()
            screen.AddRenderer(renderer)
        taken = vtkWindowToImageFilter()
        taken.SetInput(screen)
        taken.ReadFrontBufferOff()
        taken.Update()
        for renderer in layers:
            screen.RemoveRenderer(renderer)
        fine = vtk_to_numpy(taken.GetOutput().GetPointData().GetScalars()).reshape(rows, FINER, columns, FINER, 3)
        parts = [fine[:, i, :, j].astype(np.float32) for i in range(FINER) for j in range(FINER)]
        return sum(parts) / np.float32(255 * FINER**2)


class SpaceImage(Artist):
    """A scene in axes whose coordinates are those of a camera, drawn in the very pixels that the axes have.

    Args:
        axes: to draw in.
        camera: looks at the scene.
        factor: of the axes' coordinates over metres.
        opacity: of the veil, a translucent part of the scene that is seen as one.
        outline: colour of the veil's outline, dashed where the scene hides it; None: it has none.
    """

    zorder = 2

    def __init__(
        self, axes: Axes, camera: Camera, factor: float = 1.0, opacity: float = 1.0, outline: Any = None
    ) -> None:
        super().__init__()
        self.camera, self.factor, self.opacity, self.outline = camera, factor, opacity, outline
        self.scene, self.veil = SpaceDrawing(), SpaceDrawing()
        self._drawn: tuple[Any, np.ndarray] | None = None
        self.set_in_layout(False)
        axes.add_artist(self)

    def draw(self, renderer: RendererBase) -> None:
        """Draw the scene where the axes are."""
        box = self.axes.bbox
        low, high = np.floor([box.x0, box.y0]).astype(int), np.ceil([box.x1, box.y1]).astype(int)
        (left, bottom), (right, top) = self.axes.transData.inverted().transform([low, high]) / self.factor
        columns, rows = map(int, high - low)
        view = (left, right, bottom, top), columns, rows, renderer.points_to_pixels(1.0)
        made = (*view, self.scene, self.veil)
        # Figures that are laid out are drawn twice, the first time for nothing.
        if self._drawn is None or self._drawn[0] != made:
            opaque = np.full((rows, columns, 4), 255, dtype=np.uint8)
            opaque[..., :3] = np.round(255.0 * self.pixels(*view))
            self._drawn = made, opaque
        renderer.draw_image(renderer.new_gc(), float(low[0]), float(low[1]), self._drawn[1])

    def pixels(self, window: Window, columns: int, rows: int, point: float = 1.0) -> np.ndarray:
        """The picture (rows, columns, 3) of a window, as `SpaceDrawing.pixels` has it, with its veil."""
        view = self.camera, window, columns, rows, point
        bare = self.scene.pixels(*view)
        if self.veil.empty:
            return bare
        veiled = SpaceDrawing(self.scene, self.veil).pixels(*view)
        picture = (1.0 - self.opacity) * bare + self.opacity * veiled
        if self.outline is not None:
            there = (self.veil.pixels(*view) < 1.0).any(axis=2)
            dashed = np.indices(there.shape).sum(axis=0) // int(DASH * point) % 2 == 0
            line, hidden = there & ~binary_erosion(there, border_value=1), (veiled == bare).all(axis=2)
            picture[line & ~hidden] = to_rgb(self.outline)
            picture[line & hidden & dashed] *= PALE
        return picture


@cache
def _screen() -> vtkEGLRenderWindow:
    """What is drawn in; to make one takes longer than to draw.

    Raises:
        UserError: this machine has no OpenGL off screen.
    """
    try:
        # Without this library VTK ends the whole process.
        CDLL("libEGL.so.1")
    except OSError as error:
        raise UserError("VTK finds no EGL to draw with", "pictures in space", "install it: Debian's libegl1") from error
    screen = vtkEGLRenderWindow()
    screen.SetOffScreenRendering(1)
    screen.SetMultiSamples(0)
    screen.SetNumberOfLayers(TOP + 1)
    screen.SwapBuffersOff()
    if not screen.SupportsOpenGL():
        raise UserError("EGL draws nothing here", "pictures in space", "install a driver: Debian's libgl1-mesa-dri")
    vtkMapper.SetResolveCoincidentTopologyToPolygonOffset()
    return screen


def _reach(actor: vtkActor, camera: Camera) -> float:
    """How far an actor reaches from the centre of a camera towards it, at most [m]."""
    low, high = np.reshape(actor.GetBounds(), (3, 2)).T - camera.center
    return float(np.maximum(camera.axes[2] * low, camera.axes[2] * high).sum())


def _vtk_camera(camera: Camera, window: Window, reach: float) -> vtkCamera:
    """VTK's camera; with parallel rays it stands before all that reaches so far [m]; it sees nothing behind it."""
    left, right, bottom, top = window
    found = vtkCamera()
    distance = camera.distance if np.isfinite(camera.distance) else 1.0 + max(0.0, reach)
    found.SetFocalPoint(*camera.center)
    found.SetPosition(*(camera.center + distance * camera.axes[2]))
    found.SetViewUp(*camera.axes[1])
    found.SetWindowCenter((left + right) / (right - left), (bottom + top) / (top - bottom))
    found.SetParallelProjection(not np.isfinite(camera.distance))
    found.SetParallelScale(0.5 * (top - bottom))
    found.SetViewAngle(2.0 * np.degrees(np.arctan2(0.5 * (top - bottom), distance)))
    return found


def _renderer(layer: int) -> vtkRenderer:
    found = vtkRenderer()
    found.SetLayer(layer)
    found.SetBackground(1.0, 1.0, 1.0)
    found.AutomaticLightCreationOff()
    light = vtkLight()
    light.SetLightTypeToCameraLight()
    light.SetPosition(*LIGHT)
    light.SetFocalPoint(0.0, 0.0, 0.0)
    found.AddLight(light)
    return found


def _coloured(data: vtkPolyData, colours: Any, at_places: bool = False) -> vtkPolyData:
    """The same with the colours (m, 3) of its cells, or of its places, if they are of each."""
    if np.ndim(colours) == 2:
        coloured = data.GetPointData() if at_places else data.GetCellData()
        coloured.SetScalars(_vtk(np.round(255.0 * np.asarray(colours)).astype(np.uint8)))
    return data


def _actor(data: vtkPolyData, colour: Any) -> vtkActor:
    """What VTK draws, unlit, in one colour; cells that have their own keep them."""
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    if np.ndim(colour) < 2:
        look.SetColor(*to_rgb(colour))
    look.LightingOff()
    return actor


def _smoothed(data: vtkPolyData, sharp: float) -> vtkPolyData:
    """The surface with normals at its nodes."""
    normals = vtkPolyDataNormals()
    normals.SetInputData(data)
    normals.SetFeatureAngle(sharp)
    normals.Update()
    return normals.GetOutput()


def _sides_of(low: np.ndarray, high: np.ndarray) -> Iterator[vtkPlane]:
    """The planes around a box, which look inwards."""
    for corner, inwards in ((low, 1.0), (high, -1.0)):
        for axis in np.eye(3):
            plane = vtkPlane()
            plane.SetOrigin(*corner)
            plane.SetNormal(*(inwards * axis))
            yield plane


def _line_data(ends: np.ndarray) -> vtkPolyData:
    return _poly_data(ends.reshape(-1, 3), lines=np.arange(2 * len(ends)).reshape(-1, 2))


def _poly_data(places: np.ndarray, faces: np.ndarray | None = None, lines: np.ndarray | None = None) -> vtkPolyData:
    """Places (n, 3) with faces (m, k) and lines (m, 2) between them, as VTK has them."""
    data, points = vtkPolyData(), vtkPoints()
    points.SetData(_vtk(np.asarray(places, dtype=float)))
    data.SetPoints(points)
    for cells, put in ((faces, data.SetPolys), (lines, data.SetLines)):
        if cells is not None:
            corners = cells.shape[1]
            array = vtkCellArray()
            array.SetData(corners, numpy_to_vtkIdTypeArray(cells.astype(np.int64).ravel(), deep=True))
            put(array)
    return data


def _vtk(values: np.ndarray) -> Any:
    """An array that keeps its values for itself."""
    return numpy_to_vtk(np.ascontiguousarray(values), deep=True)
