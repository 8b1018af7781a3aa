// Straight pieces of lines, as many pixels wide at any distance: a rectangle each; or the heads of arrows. They are no instances
// of one rectangle: where there is no graphics card, each instance is drawn by itself, which takes ten times as long.

import { BufferAttribute, BufferGeometry, Color, GLSL3, Mesh, ShaderMaterial, type IUniform } from "three";

import { refresh, room } from "./buffers";
import { drawnBy } from "./drawn";
import type { Shared } from "./shared";

const VERTEX = /* glsl */ `
in vec3 begin, end, beginShift, endShift;
uniform float scale, width, moves, headLength, pixels;
uniform vec2 size;
out float vAcross, vHalf;
void main() {
  int number = gl_VertexID & 3; // of the corner of the rectangle, around it
  vec2 corner = vec2(number == 1 || number == 2, number < 2 ? -1 : 1);
  vec4 a = projectionMatrix * (modelViewMatrix * vec4(begin + moves * scale * beginShift, 1.0));
  vec4 b = projectionMatrix * (modelViewMatrix * vec4(end + moves * scale * endShift, 1.0));
  vec2 way = (b.xy / b.w - a.xy / a.w) * size;
  float span = length(way);
  vec2 along = span > 1e-6 ? way / span : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  float wide = width * pixels;
  float head = headLength * pixels;
  vHalf = 0.5 * wide;
  vec4 place = corner.x < 0.5 ? a : b;
  vec2 off;
  if (head > 0.0) { // a triangle whose tip is the end
    vHalf = 1e3;
    vAcross = 0.0;
    place = b;
    off = corner.x > 0.5 ? vec2(0.0) : -along * head + across * corner.y * 0.38 * head;
    if (span < 1.0) off = vec2(0.0);
  } else {
    vAcross = corner.y * (vHalf + 1.0);
    off = across * vAcross + along * (corner.x - 0.5) * 0.6 * wide;
  }
  place.xy += 2.0 * off / size * place.w;
  place.z -= 4e-5 * place.w;
  gl_Position = place;
}`;

const FRAGMENT = /* glsl */ `
uniform vec3 colour;
uniform float opacity;
in float vAcross, vHalf;
layout(location = 0) out vec4 shown;
void main() {
  float cover = clamp(vHalf + 0.5 - abs(vAcross), 0.0, 1.0);
  shown = vec4(colour, opacity * cover);
}`;

export interface SegmentLook { colour: Color; width: number; opacity?: number; through?: boolean; moves?: boolean; head?: number; }

const NONE = new Float32Array(0);

export class Segments {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  readonly colour: IUniform<Color>;
  readonly moves: IUniform<number>;
  readonly width: IUniform<number>;
  readonly opacity: number;
  readonly head: number;
  readonly through: boolean;
  points: Float32Array = NONE;
  shifts: Float32Array = NONE;
  pairs: ArrayLike<number> = [];
  private stale = false;                             // the graphics card has what was before
  private count = 0;

  /** through: seen through surfaces. moves: with displacements. head: length of an arrow's head in pixels. */
  constructor(shared: Shared, look: SegmentLook) {
    this.colour = { value: look.colour };
    this.width = { value: look.width };
    this.moves = { value: look.moves === false ? 0 : 1 };
    this.opacity = look.opacity ?? 1;
    this.head = look.head ?? 0;
    this.through = look.through === true;
    const geometry = new BufferGeometry();
    geometry.setDrawRange(0, 0);
    this.mesh = new Mesh(geometry, new ShaderMaterial({
      glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true, depthWrite: false,
      depthTest: !look.through, side: 2,
      uniforms: {
        scale: shared.scale, size: shared.size, pixels: shared.pixels, colour: this.colour, moves: this.moves,
        width: this.width, opacity: { value: this.opacity }, headLength: { value: this.head },
      },
    }));
    this.mesh.frustumCulled = false;
    this.mesh.matrixAutoUpdate = false;
    drawnBy(this.mesh, this);
  }

  look(colour: Color, width: number): void {
    this.colour.value = colour;
    this.width.value = width;
  }

  /** Pieces between pairs of points; `pairs` are numbers of points, two each. */
  setPairs(points: Float32Array, shifts: Float32Array, pairs: ArrayLike<number>): void {
    [this.points, this.shifts, this.pairs] = [points, shifts, pairs];
    this.count = pairs.length >> 1;
    this.mesh.visible = this.count > 0;
    this.stale = true;
  }

  /** Fills what the graphics card draws. */
  ready(): void {
    if (!this.stale) return;
    this.stale = false;
    const { points, shifts, pairs, count } = this;
    const { geometry } = this.mesh;
    const begins = room(geometry, "begin", 4 * count, 3), ends = room(geometry, "end", 4 * count, 3);
    const beginShifts = room(geometry, "beginShift", 4 * count, 3), endShifts = room(geometry, "endShift", 4 * count, 3);
    for (let i = 0; i < count; i += 1) {
      const a = 3 * pairs[2 * i]!;
      const b = 3 * pairs[2 * i + 1]!;
      for (let to = 12 * i, k = 0; k < 12; k += 1, to += 1) {
        const axis = k % 3;
        begins[to] = points[a + axis]!;
        ends[to] = points[b + axis]!;
        beginShifts[to] = shifts.length ? shifts[a + axis]! : 0;
        endShifts[to] = shifts.length ? shifts[b + axis]! : 0;
      }
    }
    this.shown(count);
  }

  /** Lines through points, each from its start to that of the next. */
  setLines(points: Float32Array, shifts: Float32Array, starts: ArrayLike<number>): void {
    this.setPairs(points, shifts, pairsOf(points.length / 3, starts));
  }

  private shown(count: number): void {
    const { geometry } = this.mesh;
    for (const name of ["begin", "end", "beginShift", "endShift"]) refresh(geometry, name, 4 * count);
    if ((geometry.index?.count ?? 0) < 6 * count) geometry.setIndex(new BufferAttribute(rectangles(2 * count), 1));
    geometry.setDrawRange(0, 6 * count);
  }

  get empty(): boolean { return this.count === 0; }

  clear(): void {
    [this.points, this.shifts, this.pairs, this.count] = [NONE, NONE, [], 0];
    this.mesh.visible = false;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}

/** Corners of two triangles for each of some rectangles, which have four corners each. */
function rectangles(count: number): Uint32Array {
  const corners = new Uint32Array(6 * count);
  for (let i = 0; i < count; i += 1) corners.set([4 * i, 4 * i + 1, 4 * i + 2, 4 * i, 4 * i + 2, 4 * i + 3], 6 * i);
  return corners;
}

/** Numbers of the points at both ends of each straight piece. */
export function pairsOf(count: number, starts: ArrayLike<number>): number[] {
  const pairs: number[] = [];
  for (let line = 0; line < starts.length; line += 1) {
    const end = line + 1 < starts.length ? starts[line + 1]! : count;
    for (let i = starts[line]!; i + 1 < end; i += 1) pairs.push(i, i + 1);
  }
  return pairs;
}
