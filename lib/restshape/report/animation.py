"""A moving picture of a recording: GIF by Pillow, MP4 where ffmpeg is installed."""

# More than 15 modules: all that a frame shows is drawn again for each.

import shutil
import subprocess
from collections.abc import Collection, Iterator
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap, to_rgb
from matplotlib.figure import Figure
from PIL import Image

from restshape.errors import UserError
from restshape.outputs.picture_files import count_picture
from restshape.replay.recording.recording import Recording
from restshape.report.conditions import LOADS, SUPPORT
from restshape.report.drawing import Drawing
from restshape.report.frames import (
    BELOW,
    LEFT,
    LETTER,
    LINE,
    RIGHT,
    add_colour_bar,
    findings,
    title_lines,
    wrapped,
)
from restshape.report.happenings import failure
from restshape.report.overlay import USUAL, overlay, vector_segments
from restshape.report.scenery import Scenery
from restshape.report.style import BODY, INK, MARK, MESH, REFUSED, new_figure

FRAMES = 40
DPI = 90
LINES = 2
"""Of the caption."""
_SECONDS = (0.05, 0.25)


def animated_frames(recording: Recording, most: int = FRAMES) -> np.ndarray:
    """Indices of every n-th frame, the last one too."""
    step = max(1, -(-recording.n // most))
    return np.unique(np.append(np.arange(0, recording.n, step), recording.n - 1))


def require_ffmpeg() -> str:
    """The path of ffmpeg.

    Raises:
        UserError: it is not installed.
    """
    found = shutil.which("ffmpeg")
    if found is None:
        raise UserError("MP4 needs ffmpeg, which is not installed", "--animation", "--animation gif, or install ffmpeg")
    return found


def draw_animation(
    recording: Recording, chosen: np.ndarray, scenery: Scenery, path: Path, things: Collection[str] = USUAL
) -> None:
    """Writes the animation; the suffix of the path says which kind.

    Args:
        recording: of a shape in the plane.
        chosen: frames to draw.
        scenery: scale, extent and colours.
        path: ``.gif`` or ``.mp4``.
        things: what frames show besides the field, some of mesh, goal, vectors, and `overlay.REBUILT`.

    Raises:
        UserError: MP4 without ffmpeg, ffmpeg failed, or a thing cannot be shown.
    """
    write_animation(
        _pictures(recording, chosen, scenery, things), _palette(scenery.colours), path, pause(recording, chosen)
    )


def write_animation(
    pictures: Iterator[np.ndarray], palette: np.ndarray, path: Path, seconds: float, comment: str = ""
) -> None:
    """Writes pictures as a GIF or an MP4; the suffix of the path says which.

    Args:
        pictures: (height, width, 3) uint8, all of one size, which is even.
        palette: (256, 3) uint8 colours of a GIF, for all pictures, so that nothing flickers.
        path: ``.gif`` or ``.mp4``.
        seconds: a picture.
        comment: that a GIF has in it.

    Raises:
        UserError: MP4 without ffmpeg, or ffmpeg failed.
    """
    counted = _counted(pictures)
    if path.suffix == ".mp4":
        _write_mp4(counted, path, seconds)
    else:
        _write_gif(counted, palette, path, seconds, comment)


def _counted(pictures: Iterator[np.ndarray]) -> Iterator[np.ndarray]:
    """The same pictures, each counted when it is drawn."""
    for picture in pictures:
        count_picture()
        yield picture


def pause(recording: Recording, chosen: np.ndarray) -> float:
    """Seconds a picture: those of the edit, within what a viewer can follow."""
    t = recording.times
    duration = float(t[chosen[-1]] - t[chosen[0]]) if len(chosen) > 1 else 0.0
    return float(np.clip(duration / max(len(chosen) - 1, 1), *_SECONDS))


def _pictures(
    recording: Recording, chosen: np.ndarray, scenery: Scenery, things: Collection[str]
) -> Iterator[np.ndarray]:
    """RGB pictures (height, width, 3) uint8, both sizes even; all but the body is drawn once."""
    figure, axes, bar = _canvas(recording, scenery)
    canvas = FigureCanvasAgg(figure)
    drawing = Drawing(axes, scenery, mesh="mesh" in things, goal="goal" in things)
    over = overlay(recording, scenery, chosen, things)
    vectors = vector_segments(recording, scenery, chosen, things)
    for artist in drawing.artists:
        artist.set_animated(True)
    _, unit = scenery.unit
    axes.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]")
    words = axes.text(0.0, 1.02, "", transform=axes.transAxes, fontsize=9, animated=True)
    add_colour_bar(figure, bar, recording, scenery)
    if vectors:
        vectors.explain(figure, figure.get_figwidth() - RIGHT + 0.2, BELOW - 0.15, _inches(figure, axes, scenery))
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    room = int((figure.get_figwidth() - LEFT) / LETTER)
    for i in map(int, chosen):
        canvas.restore_region(still)
        drawing.show(recording, i)
        found = (f"frame {i}", *recording.moments(i), *findings(recording, i, scenery))
        words.set_text("\n".join(wrapped(found, room).split("\n")[:LINES]))
        words.set_color(REFUSED if failure(recording, i, bool(scenery.seen.solved[i])) else INK)
        above = vectors.draw(axes, i) if vectors and scenery.seen.solved[i] else []
        above += over.draw(axes, i) if over else []
        for shown in (*drawing.artists, *above, words):
            axes.draw_artist(shown)
        for shown in above:
            shown.remove()
        yield even(canvas)


def _canvas(recording: Recording, scenery: Scenery) -> tuple[Figure, Axes, Axes]:
    """A figure with its title, the axes of the shape, and those of the colour bar."""
    xmin, xmax, ymin, ymax = scenery.extent
    aspect = (xmax - xmin) / (ymax - ymin)
    room = 6.2 if aspect > 1 else 4.0
    height = min(room / aspect, 7.5)
    width = height * aspect
    wide = max(LEFT + width + RIGHT, 4.5)
    heading = title_lines(recording, scenery, wide, LETTER)
    top = 0.15 + LINE * (len(heading) + LINES) + 0.1
    high = top + height + BELOW
    figure = new_figure(wide, high)
    figure.set(dpi=DPI, layout_engine="none")
    figure.suptitle("\n".join(heading), color=INK, fontsize=8.5, y=1.0 - 0.06 / high, va="top")
    axes = figure.add_axes((LEFT / wide, BELOW / high, width / wide, height / high))
    length = min(height, 5.0)
    bar = figure.add_axes(
        (1.0 - (RIGHT - 0.25) / wide, (BELOW + 0.5 * (height - length)) / high, 0.14 / wide, length / high)
    )
    return figure, axes, bar


def _inches(figure: Figure, axes: Axes, scenery: Scenery) -> float:
    """Length of a metre of the shape in a figure [inch]."""
    xmin, xmax, *_ = scenery.extent
    return float(axes.get_position().width * figure.get_figwidth() / (xmax - xmin))


def even(canvas: FigureCanvasAgg) -> np.ndarray:
    """The picture (height, width, 3) uint8 on a canvas, cut to even sizes."""
    picture = np.asarray(canvas.buffer_rgba())[:, :, :3]
    return np.ascontiguousarray(picture[: picture.shape[0] // 2 * 2, : picture.shape[1] // 2 * 2])


def _write_gif(
    pictures: Iterator[np.ndarray], palette: np.ndarray, path: Path, seconds: float, comment: str = ""
) -> None:
    frames: list[Image.Image] = []
    nearest = _nearest(palette)
    for picture in pictures:
        red, green, blue = np.moveaxis(picture >> 3, -1, 0).astype(np.int32)
        image = Image.fromarray(nearest[red << 10 | green << 5 | blue])
        image.putpalette(palette.tobytes())
        frames.append(image)
    said = {"comment": comment.encode()} if comment else {}
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=round(1000 * seconds), loop=0, **said)


def _palette(colours: Colormap) -> np.ndarray:
    """256 colours: the map's, the map's under mesh lines, greys, and those of words and marks."""
    shades = colours(np.linspace(0, 1, 138))[:, :3]
    under = 0.75 * shades[::2] + 0.25 * np.array(to_rgb(MESH))
    greys = np.repeat(np.linspace(0, 1, 39)[:, None], 3, axis=1)
    all_colours = np.vstack([shades, under, greys, *map(to_rgb, (BODY, MARK, REFUSED, *LOADS, SUPPORT))])
    return (255 * all_colours).round().astype(np.uint8)


def _nearest(palette: np.ndarray) -> np.ndarray:
    """Index of the nearest colour (32 * 32 * 32,) uint8 for colours of 5 bits a channel."""
    channel = np.arange(32, dtype=np.float32) * np.float32(255 / 31)
    red, green, blue = palette.astype(np.float32).T
    # The less of the square of the distance, but for that of the colour, which is the same for all of the palette.
    # Not a product of matrices: to start BLAS takes longer than all of it.
    rest = channel[:, None, None] * green + channel[:, None] * blue - 0.5 * (red**2 + green**2 + blue**2)
    return np.stack([(one * red + rest).argmax(axis=-1) for one in channel]).ravel().astype(np.uint8)


def _write_mp4(pictures: Iterator[np.ndarray], path: Path, seconds: float) -> None:
    command = [require_ffmpeg(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    first = next(pictures)
    height, width, _ = first.shape
    command += ["-s", f"{width}x{height}", "-r", f"{1 / seconds:.3f}", "-i", "-", "-pix_fmt", "yuv420p", str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdin is not None and process.stderr is not None
        try:
            process.stdin.write(first.tobytes())
            for picture in pictures:
                process.stdin.write(picture.tobytes())
            process.stdin.close()
        except BrokenPipeError:
            pass
        said = process.stderr.read().decode(errors="replace").strip()
    if process.returncode:
        raise UserError(f"ffmpeg failed: {said.splitlines()[-1] if said else process.returncode}", str(path), "use gif")
