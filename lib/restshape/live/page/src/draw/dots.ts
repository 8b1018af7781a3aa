// Round dots of as many pixels at any distance.

import { BufferGeometry, Color, GLSL3, Points, ShaderMaterial, type IUniform } from "three";

import { refresh, room } from "./buffers";
import { drawnBy } from "./drawn";
import type { Shared } from "./shared";

const VERTEX = /* glsl */ `
in vec3 shift;
uniform float scale, width, pixels, moves;
void main() {
  gl_Position = projectionMatrix * (modelViewMatrix * vec4(position + moves * scale * shift, 1.0));
  gl_Position.z -= 8e-5 * gl_Position.w;
  gl_PointSize = width * pixels + 1.0;
}`;

const FRAGMENT = /* glsl */ `
uniform vec3 colour, rim;
uniform float width, pixels;
layout(location = 0) out vec4 shown;
void main() {
  float r = length(gl_PointCoord - 0.5) * (width * pixels + 1.0);
  float cover = clamp(0.5 * width * pixels + 0.5 - r, 0.0, 1.0);
  float inner = clamp(0.5 * width * pixels - (width > 5.0 ? 1.2 : 0.7) * pixels + 0.5 - r, 0.0, 1.0);
  if (cover <= 0.0) discard;
  shown = vec4(mix(rim, colour, inner), cover);
}`;

export interface DotLook { colour: Color; rim: Color; width: number; through?: boolean; moves?: boolean; }

const NONE = new Float32Array(0);

export class Dots {
  readonly points: Points<BufferGeometry, ShaderMaterial>;
  readonly colour: IUniform<Color>;
  readonly rim: Color;
  through: boolean;
  readonly moves: IUniform<number>;
  readonly width: IUniform<number>;
  places: Float32Array = NONE;
  shifts: Float32Array = NONE;
  count = 0;
  private stale = false;                             // the graphics card has what was before

  constructor(shared: Shared, look: DotLook) {
    this.colour = { value: look.colour };
    this.width = { value: look.width };
    this.moves = { value: look.moves === false ? 0 : 1 };
    this.rim = look.rim;
    this.through = look.through === true;
    this.points = new Points(new BufferGeometry(), new ShaderMaterial({
      glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true, depthWrite: false, depthTest: !look.through,
      uniforms: {
        scale: shared.scale, pixels: shared.pixels, moves: this.moves,
        colour: this.colour, rim: { value: look.rim }, width: this.width,
      },
    }));
    this.points.frustumCulled = false;
    this.points.matrixAutoUpdate = false;
    drawnBy(this.points, this);
  }

  look(colour: Color, width: number, through = this.through): void {
    this.colour.value = colour;
    this.width.value = width;
    this.through = through;
    this.points.material.depthTest = !through;
  }

  set(points: Float32Array, shifts: Float32Array, count = points.length / 3): void {
    [this.places, this.shifts, this.count] = [points, shifts, count];
    this.points.visible = count > 0;
    this.stale = true;
  }

  /** Fills what the graphics card draws. */
  ready(): void {
    if (!this.stale) return;
    this.stale = false;
    const { places, shifts, count } = this;
    const { geometry } = this.points;
    room(geometry, "position", count, 3).set(places.subarray(0, 3 * count));
    const all = room(geometry, "shift", count, 3);
    if (shifts.length) all.set(shifts.subarray(0, 3 * count));
    else all.fill(0);
    refresh(geometry, "position", count);
    refresh(geometry, "shift", count);
    geometry.setDrawRange(0, count);
  }

  get empty(): boolean { return this.count === 0; }

  clear(): void {
    this.count = 0;
    this.points.visible = false;
  }

  dispose(): void {
    this.points.geometry.dispose();
    this.points.material.dispose();
  }
}
