// Draws without a graphics card, pixel by pixel: a browser's WebGL in software needs many times as long, and its pixels are
// read back before they are shown.

import { Color, type Camera, type Object3D } from "three";

import { CardDrawer } from "./card_drawer";
import { Dots } from "./dots";
import type { Drawer, Means } from "./drawer";
import { whatDraws } from "./drawn";
import { Segments } from "./segments";
import type { Shared } from "./shared";
import { Depth } from "./software/depth";
import { fillLit } from "./software/lit_triangles";
import { LitPalette } from "./software/lit_palette";
import { Palette, VALUES, type Tint } from "./software/palette";
import { NEAREST, Placed, turned } from "./software/placed";
import { bytesOf, Raster } from "./software/raster";
import { dot, head, line, type Behind, type Ink } from "./software/strokes";
import { fill } from "./software/triangles";
import { Surface } from "./surface";
import { wireShare } from "./surface_shader";

const WHITES = 64; // steps of how white edges are, so that colours are not made anew with each frame
const NEARER = { lines: 4e-5, dots: 8e-5 }; // depth by which they lie before what they are on

export class SoftwareDrawer implements Drawer {
  readonly early = true;
  private readonly pen: CanvasRenderingContext2D;
  private readonly raster = new Raster();
  private readonly depth = new Depth();
  private readonly palettes = new WeakMap<Surface, Palette>();
  private readonly litPalettes = new WeakMap<Surface, LitPalette>();
  private readonly placed = new Placed();
  private ground = new Color();
  private shares = new Float32Array(0);
  private normals: Float32Array = new Float32Array(0);
  private card: CardDrawer | null = null;            // what the eye is in the middle of is drawn by WebGL
  private size = { width: 1, height: 1, ratio: 1 };

  /** Throws where the canvas draws no pixels. */
  constructor(
    private readonly canvas: HTMLCanvasElement, private readonly shared: Shared, private readonly inSpace: boolean, private readonly means: Means,
  ) {
    const pen = canvas.getContext("2d", { alpha: false });
    if (!pen) throw new Error("no canvas of pixels");
    this.pen = pen;
  }

  resize(width: number, height: number, ratio: number): void {
    this.size = { width, height, ratio };
    const [across, up] = [Math.floor(width * ratio), Math.floor(height * ratio)];
    if (this.canvas.width !== across) this.canvas.width = across;
    if (this.canvas.height !== up) this.canvas.height = up;
    this.raster.resize(across, up);
    if (this.inSpace) this.depth.resize(across, up);
  }

  clearTo(colour: Color): void { this.ground = colour; }

  draw(scene: Object3D, camera: Camera): void {
    camera.updateMatrixWorld();
    const before = this.raster.clear(this.ground);
    if (this.inSpace) this.depth.clear(before);
    const objects: Object3D[] = [];
    scene.traverseVisible((object) => { if (whatDraws(object)) objects.push(object); });
    for (const object of objects.sort(inOrder)) {
      if (this.one(whatDraws(object), camera)) continue;
      this.byWebGL(scene, camera);
      return;
    }
    const changed = this.raster.changed();
    if (!this.raster.image || !changed) return;
    const { left, top, right, bottom } = changed;
    this.pen.putImageData(this.raster.image, 0, 0, left, top, right - left, bottom - top);
  }

  private byWebGL(scene: Object3D, camera: Camera): void {
    const { width, height, ratio } = this.size;
    this.card ??= new CardDrawer(document.createElement("canvas"));
    this.card.resize(width, height, ratio);
    this.card.clearTo(this.ground);
    this.card.draw(scene, camera);
    this.pen.drawImage(this.card.canvas, 0, 0);
    this.raster.forget();
  }

  /** Draws a thing; false where it reaches behind the eye, and WebGL can draw that. */
  private one(drawn: unknown, camera: Camera): boolean {
    if (drawn instanceof Surface) return this.surface(drawn, camera);
    if (drawn instanceof Segments) return this.segments(drawn, camera);
    return !(drawn instanceof Dots) || this.dots(drawn, camera);
  }

  private surface(surface: Surface, camera: Camera): boolean {
    const { points, shifts, cells, inCells } = surface;
    if (!cells.length) return true;
    if (!this.place(points, shifts, points.length / 3, this.shared.scale.value, 1, camera)) return false;
    const tint = this.tint(surface, camera), { x, y, z, seen } = this.placed;
    const filled = { x, y, cells, shares: this.sharesOf(surface), inCells, element: tint.wire > 0 ? surface.element : 0 };
    if (this.inSpace) {
      const sums = surface.sums();
      if (sums) this.normals = turned(sums, camera.matrixWorldInverse, this.normals);
      fillLit(this.raster, this.depth, { ...filled, z, seen, normals: sums && this.normals }, made(this.litPalettes, surface, LitPalette, tint), tint.wire);
    } else fill(this.raster, filled, made(this.palettes, surface, Palette, tint));
    return true;
  }

  private tint(surface: Surface, camera: Camera): Tint {
    const { shared, placed } = this, far = this.inSpace ? Math.max(-placed.seen[2]!, 1e-9) : 1;
    const pixels = (0.5 * surface.tall.value * camera.projectionMatrix.elements[5] * shared.size.value.y) / far;
    return {
      map: shared.map.value.image.data as Uint8Array, body: bytesOf(surface.colour), glowing: bytesOf(shared.glowing.value),
      glow: surface.glow.value, wire: surface.hasWires ? Math.round(WHITES * wireShare(pixels)) / WHITES : 0,
    };
  }

  /** How far along the colours values are. */
  private sharesOf(surface: Surface): Float32Array {
    const { values, inCells, cells, points } = surface;
    const count = inCells ? cells.length : points.length / 3;
    if (this.shares.length < count) this.shares = new Float32Array(Math.ceil(1.3 * count));
    const { x: low, y: high } = this.shared.ends.value, factor = VALUES / (high - low);
    if (!surface.coloured.value) this.shares.fill(NaN, 0, count);
    else for (let i = 0; i < count; i += 1) this.shares[i] = (values[i]! - low) * factor;
    return this.shares;
  }

  private segments(segments: Segments, camera: Camera): boolean {
    const { points, shifts, pairs, moves } = segments, { pixels } = this.shared;
    const wide = segments.width.value * pixels.value, long = segments.head * pixels.value;
    if (!this.place(points, shifts, points.length / 3, moves.value * this.shared.scale.value, wide + 1.4 * long + 1, camera)) return false;
    const { x, y, z } = this.placed, ink = inkOf(segments.colour.value, segments.opacity);
    for (let i = 0; i + 1 < pairs.length; i += 2) {
      const a = pairs[i]!, b = pairs[i + 1]!;
      if (z[a]! < NEAREST || z[b]! < NEAREST) continue;
      const behind = this.behind(segments.through, z[a]! - NEARER.lines, z[b]! - NEARER.lines);
      if (long > 0) head(this.raster, x[a]!, y[a]!, x[b]!, y[b]!, long, ink, behind);
      else line(this.raster, x[a]!, y[a]!, x[b]!, y[b]!, wide, ink, behind);
    }
    return true;
  }

  private dots(dots: Dots, camera: Camera): boolean {
    const { pixels } = this.shared, wide = dots.width.value * pixels.value;
    if (!this.place(dots.places, dots.shifts, dots.count, dots.moves.value * this.shared.scale.value, wide, camera)) return false;
    const { x, y, z } = this.placed, inside = inkOf(dots.colour.value), rim = inkOf(dots.rim);
    for (let i = 0; i < dots.count; i += 1) {
      if (z[i]! < NEAREST) continue;
      dot(this.raster, x[i]!, y[i]!, wide, (dots.width.value > 5 ? 1.2 : 0.7) * pixels.value, inside, rim, this.behind(dots.through, z[i]! - NEARER.dots, 0));
    }
    return true;
  }

  private behind(through: boolean, from: number, to: number): Behind | null {
    return through || !this.inSpace ? null : { depth: this.depth, from, to };
  }

  /** Puts places onto the picture; what is there may take so many pixels around. False: some lie behind the eye, which WebGL can draw. */
  private place(points: Float32Array, shifts: Float32Array, count: number, scale: number, around: number, camera: Camera): boolean {
    const { placed, raster } = this;
    placed.take(points, shifts, count, scale, camera, raster.width, raster.height);
    if (this.inSpace && placed.least < NEAREST && this.means === "processor") return false;
    if (placed.left <= placed.right) {
      raster.reach(placed.left, placed.top, around);
      raster.reach(placed.right, placed.bottom, around);
    }
    return true;
  }
}

/** The palette of a surface, for a tint. */
function made<P extends { make(tint: Tint, valued: boolean): void }>(all: WeakMap<Surface, P>, of: Surface, Kind: new () => P, tint: Tint): P {
  let found = all.get(of);
  if (!found) all.set(of, found = new Kind());
  found.make(tint, of.hasValues && of.coloured.value > 0);
  return found;
}

/** Surfaces first, and then by their order; those of the same order as they were made. */
function inOrder(a: Object3D, b: Object3D): number {
  const over = (object: Object3D): number => (whatDraws(object) instanceof Surface ? 0 : 1);
  return over(a) - over(b) || a.renderOrder - b.renderOrder || a.id - b.id;
}

function inkOf(colour: Color, opacity = 1): Ink {
  const [red, green, blue] = bytesOf(colour);
  return { red, green, blue, opacity };
}
