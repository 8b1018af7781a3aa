"""A moving picture of a recording: GIF by Pillow, MP4 where ffmpeg is installed."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from PIL import Image
from scipy.spatial import cKDTree

from restshape.errors import UserError
from restshape.outputs.drawn import plain_texts
from restshape.replay.recording import Recording
from restshape.report.frames import title
from restshape.report.scenery import Drawing, Scenery
from restshape.report.style import BODY, COLOURS, MESH, new_figure
from restshape.report.tables import refused

FRAMES = 40
DPI = 90
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


def draw_animation(recording: Recording, chosen: np.ndarray, scenery: Scenery, path: Path) -> None:
    """Writes the animation; the suffix of the path says which kind.

    Args:
        recording: of a shape in the plane.
        chosen: frames to draw.
        scenery: scale, extent and colours.
        path: ``.gif`` or ``.mp4``.

    Raises:
        UserError: MP4 without ffmpeg, or ffmpeg failed.
    """
    write_animation(_pictures(recording, chosen, scenery), _palette(), path, pause(recording, chosen))


def write_animation(pictures: Iterator[np.ndarray], palette: np.ndarray, path: Path, seconds: float) -> None:
    """Writes pictures as a GIF or an MP4; the suffix of the path says which.

    Args:
        pictures: (height, width, 3) uint8, all of one size, which is even.
        palette: (256, 3) uint8 colours of a GIF, for all pictures, so that nothing flickers.
        path: ``.gif`` or ``.mp4``.
        seconds: a picture.

    Raises:
        UserError: MP4 without ffmpeg, or ffmpeg failed.
    """
    if path.suffix == ".mp4":
        _write_mp4(pictures, path, seconds)
    else:
        _write_gif(pictures, palette, path, seconds)


def pause(recording: Recording, chosen: np.ndarray) -> float:
    """Seconds a picture: those of the edit, within what a viewer can follow."""
    t = recording.times
    duration = float(t[chosen[-1]] - t[chosen[0]]) if len(chosen) > 1 else 0.0
    return float(np.clip(duration / max(len(chosen) - 1, 1), *_SECONDS))


def _pictures(recording: Recording, chosen: np.ndarray, scenery: Scenery) -> Iterator[np.ndarray]:
    """RGB pictures (height, width, 3) uint8, both sizes even; all but the body is drawn once."""
    xmin, xmax, ymin, ymax = scenery.extent
    aspect = (xmax - xmin) / (ymax - ymin)
    width = 8.0 if aspect > 1 else 5.5
    figure = new_figure(width, float(np.clip((width - 1.6) / aspect + 1.1, 2.4, 9.0)))
    figure.set_dpi(DPI)
    canvas = FigureCanvasAgg(figure)
    axes = figure.subplots()
    drawing = Drawing(axes, scenery)
    _, unit = scenery.unit
    axes.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]")
    axes.set_title(" ", loc="left")
    caption = axes.text(0.0, 1.02, "", transform=axes.transAxes, fontsize=9)
    title(figure, recording, scenery, 8.5)
    if scenery.field:
        bar = figure.colorbar(drawing.body, ax=axes, extend="max" if scenery.clipped else "neither")
        bar.set_label(scenery.colour[1])
    plain_texts(figure)
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    stopped = refused(recording)
    for i in map(int, chosen):
        canvas.restore_region(still)
        drawing.show(recording, i)
        words = ", ".join((f"frame {i}", *recording.moments(i)))
        caption.set_text(words + (" (refused)" if stopped[i] else ""))
        for artist in (drawing.body, drawing.rest, caption):
            axes.draw_artist(artist)
        yield even(canvas)


def even(canvas: FigureCanvasAgg) -> np.ndarray:
    """The picture (height, width, 3) uint8 on a canvas, cut to even sizes."""
    picture = np.asarray(canvas.buffer_rgba())[:, :, :3]
    return np.ascontiguousarray(picture[: picture.shape[0] // 2 * 2, : picture.shape[1] // 2 * 2])


def _write_gif(pictures: Iterator[np.ndarray], palette: np.ndarray, path: Path, seconds: float) -> None:
    frames: list[Image.Image] = []
    nearest = _nearest(palette)
    for picture in pictures:
        red, green, blue = np.moveaxis(picture >> 3, -1, 0).astype(np.int32)
        image = Image.fromarray(nearest[red << 10 | green << 5 | blue])
        image.putpalette(palette.tobytes())
        frames.append(image)
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=round(1000 * seconds), loop=0)


def _palette() -> np.ndarray:
    """256 colours: the map's, the map's under mesh lines, greys."""
    shades = colormaps[COLOURS](np.linspace(0, 1, 140))[:, :3]
    under = 0.75 * shades[::2] + 0.25 * np.array(to_rgb(MESH))
    greys = np.repeat(np.linspace(0, 1, 45)[:, None], 3, axis=1)
    colours = np.vstack([shades, under, greys, to_rgb(BODY)])
    return (255 * colours).round().astype(np.uint8)


def _nearest(palette: np.ndarray) -> np.ndarray:
    """Index of the nearest colour (32 * 32 * 32,) uint8 for colours of 5 bits a channel."""
    channel = np.arange(32) * 255 / 31
    colours = np.stack(np.meshgrid(channel, channel, channel, indexing="ij"), axis=-1).reshape(-1, 3)
    return cKDTree(palette).query(colours)[1].astype(np.uint8)


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
