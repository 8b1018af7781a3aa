// A surface of triangles that are filled in place from the arrays of frames.

import { BufferGeometry, Color, DoubleSide, GLSL3, Mesh, ShaderMaterial, type IUniform } from "three";

import type { ArrayPlace, Part } from "../protocol";
import { refresh, room } from "./buffers";
import { drawnBy } from "./drawn";
import { addNormals } from "./normals";
import type { Shared } from "./shared";
import { SURFACE_FRAGMENT, SURFACE_VERTEX } from "./surface_shader";

export type Read = (place: ArrayPlace) => Float32Array | Uint32Array | Uint8Array;
const UNKNOWN = 1e30;
const LOOKED = 200; // triangles that tell the usual size
const NONE = new Float32Array(0);

export class Surface {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  points: Float32Array = NONE;
  shifts: Float32Array = NONE;
  cells = new Uint32Array(0);
  low = 0;
  high = 0;
  values: Float32Array = NONE;
  inCells = false;
  private normals: Float32Array = NONE;
  readonly tall: IUniform<number> = { value: 0 };
  private readonly whole: IUniform<number> = { value: 0 };
  element = 1;                                       // triangles that show an element
  readonly coloured: IUniform<number> = { value: 0 };
  readonly glow: IUniform<number> = { value: 0 };
  private bent = true;                               // since its normals were found
  private readonly stale = { places: false, shifts: false, values: false, normals: false }; // on the graphics card

  /** lit: with light and shade, as in space. smooth: nodes have normals. colour: of what has no values. */
  constructor(private readonly shared: Shared, private readonly lit: boolean, private readonly smooth: boolean, private readonly wired: boolean, readonly colour: Color) {
    const { scale, ends, map, size, glowing } = shared;
    const material = new ShaderMaterial({
      glslVersion: GLSL3, vertexShader: SURFACE_VERTEX, fragmentShader: SURFACE_FRAGMENT, side: DoubleSide,
      defines: lit ? { LIT: "" } : {}, depthTest: lit, depthWrite: lit, polygonOffset: lit, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
      uniforms: {
        scale, ends, map, glowing, body: { value: colour }, glow: this.glow, coloured: this.coloured, size, tall: this.tall,
        whole: this.whole,
      },
    });
    this.mesh = new Mesh(new BufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.mesh.matrixAutoUpdate = false;
    drawnBy(this.mesh, this);
    this.setWired();
  }

  /** Whether edges of elements are drawn. */
  get hasWires(): boolean { return this.wired && this.shared.wires; }

  /** Draws edges of elements where they are wanted. */
  setWired(): void {
    const { material } = this.mesh;
    const element = this.hasWires ? this.element : 0;
    if (material.defines["ELEMENT"] === element) return;
    material.defines["ELEMENT"] = element;
    if (element) material.defines["WIRED"] = "";
    else delete material.defines["WIRED"];
    material.needsUpdate = true;
  }

  /** Takes the arrays of a part that have changed. along: all of it has moved as it lies, if at all. */
  update(part: Part, read: Read, along = false): void {
    const { points, displacement, cells, value, valueInCells } = part.arrays;
    if (points) this.points = read(points) as Float32Array;
    if (cells) this.cells = read(cells) as Uint32Array<ArrayBuffer>;
    if (cells) this.setElement(part.element ?? 1);
    if ((points ?? cells ?? displacement) && !along) this.turnNormals();
    if ((points ?? cells) && !along) this.tall.value = heightOf(this.points, this.cells) * (this.element > 2 ? 2 : 1);
    if (displacement) this.shifts = read(displacement) as Float32Array;
    else if (points && this.shifts.length !== this.points.length) this.shifts = NONE;
    if (value ?? valueInCells) {
      this.values = read((value ?? valueInCells)!) as Float32Array;
      this.inCells = !value;
    }
    if (points ?? cells) this.stale.places = this.stale.shifts = this.stale.values = true;
    if (displacement) this.stale.shifts = true;
    if (value ?? valueInCells) this.stale.values = true;
    if (part.range) [this.low, this.high] = part.range;
    else if (value ?? valueInCells) this.findRange();
  }

  /** Normals for the scale at which displacements are drawn. */
  turnNormals(): void { this.stale.normals = this.bent = true; }

  /** Fills what the graphics card draws. */
  ready(): void {
    const { stale } = this;
    if (stale.places || stale.shifts || stale.values) this.fill(stale.places, stale.shifts, stale.values);
    if (stale.normals) this.fillNormals();
    stale.places = stale.shifts = stale.values = stale.normals = false;
  }

  /** Sums of normals at the nodes, for the scale at which displacements are drawn; null: faces are flat. */
  sums(): Float32Array | null {
    if (!this.smooth || !this.lit) return null;
    if (this.normals.length !== this.points.length) this.normals = new Float32Array(this.points.length);
    if (this.bent) addNormals(this.normals, this.points, this.shifts, this.shared.scale.value, this.cells);
    this.bent = false;
    return this.normals;
  }

  private fillNormals(): void {
    if (!this.sums()) return;
    const count = this.cells.length;
    scatter(room(this.mesh.geometry, "normal", count, 3), this.normals, this.cells);
    refresh(this.mesh.geometry, "normal", count);
  }

  get hasValues(): boolean { return this.values.length > 0; }
  get hasShifts(): boolean { return this.shifts.length > 0; }

  /** How much it lights up: 0, not at all. */
  setGlow(how: number): void { this.glow.value = how; }

  setColoured(on: boolean): void { this.coloured.value = on && this.hasValues ? 1 : 0; }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }

  private setElement(triangles: number): void {
    this.element = triangles;
    this.whole.value = this.cells.length / triangles;
    this.setWired();
  }

  private fill(places: boolean, shifts: boolean, values: boolean): void {
    const { geometry } = this.mesh;
    const count = this.cells.length;
    if (places) {
      scatter(room(geometry, "position", count, 3), this.points, this.cells);
      refresh(geometry, "position", count);
    }
    if (shifts) {
      const all = room(geometry, "shift", count, 3);
      if (this.hasShifts) scatter(all, this.shifts, this.cells);
      else all.fill(0);
      refresh(geometry, "shift", count);
    }
    if (values) this.fillValues(count);
    geometry.setDrawRange(0, count);
  }

  private fillValues(count: number): void {
    const { geometry } = this.mesh;
    const all = room(geometry, "worth", count, 1);
    const { values, cells } = this;
    if (!this.hasValues) all.fill(UNKNOWN, 0, count);
    else for (let i = 0; i < count; i += 1) {
      const value = values[this.inCells ? i : cells[i]!]!;
      all[i] = value === value ? value : UNKNOWN;
    }
    refresh(geometry, "worth", count);
  }

  private findRange(): void {
    let low = Infinity;
    let high = -Infinity;
    for (let i = 0; i < this.values.length; i += 1) {
      const value = this.values[i]!;
      if (value < low) low = value;
      if (value > high) high = value;
    }
    this.low = low;
    this.high = high;
  }
}

/** Height of a usual triangle [m]: that of an equilateral one of their mean area. */
function heightOf(points: Float32Array, cells: Uint32Array): number {
  const step = 3 * Math.ceil(cells.length / 3 / LOOKED);
  let sum = 0, count = 0;
  for (let i = 0; i < cells.length; i += step, count += 1) {
    const a = 3 * cells[i]!, b = 3 * cells[i + 1]!, c = 3 * cells[i + 2]!;
    const ux = points[b]! - points[a]!, uy = points[b + 1]! - points[a + 1]!, uz = points[b + 2]! - points[a + 2]!;
    const vx = points[c]! - points[a]!, vy = points[c + 1]! - points[a + 1]!, vz = points[c + 2]! - points[a + 2]!;
    sum += 0.5 * Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
  }
  return count ? Math.sqrt((Math.sqrt(3) * sum) / count) : 0;
}

/** Three numbers of a node to each corner of a triangle. */
function scatter(to: Float32Array, from: Float32Array, cells: Uint32Array): void {
  for (let i = 0, k = 0; i < cells.length; i += 1, k += 3) {
    const at = 3 * cells[i]!;
    to[k] = from[at]!;
    to[k + 1] = from[at + 1]!;
    to[k + 2] = from[at + 2]!;
  }
}
