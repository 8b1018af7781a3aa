// Where the picture is seen from: the plane from above with pan and zoom, space from a camera that goes around.

import { MOUSE, OrthographicCamera, PerspectiveCamera, TOUCH, Vector2, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import type { Bounds } from "./bounds";

const MARGIN = 1.3; // of the shape's size: displacements and arrows have room
const SPARE = 1.12; // of the distance in space: words, arrows and buttons have room
const EDGE = 0.05; // of the picture, in which a shape counts as outside
const ANGLE = 28; // degrees that the camera in space sees
const FROM = new Vector3(0.55, -0.95, 0.55).normalize();

export interface Ray { origin: Vector3; direction: Vector3; }

export class View {
  readonly camera: OrthographicCamera | PerspectiveCamera;
  readonly controls: OrbitControls;
  moving = false;                                    // by a hand on the picture
  private width = 1;
  private height = 1;
  private half = new Vector2(1, 1);                  // of what the plane view shows without zoom
  private covered = { above: 0, below: 0 };          // pixels of the plane view that buttons and colours lie over
  private readonly work = new Vector3();

  constructor(canvas: HTMLCanvasElement, readonly dim: 2 | 3, changed: () => void) {
    this.camera = dim === 2 ? new OrthographicCamera() : new PerspectiveCamera(ANGLE);
    this.camera.up.set(0, dim === 2 ? 1 : 0, dim === 2 ? 0 : 1);
    this.camera.position.set(0, dim === 2 ? 0 : -1, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.enableRotate = dim === 3;
    this.controls.screenSpacePanning = true;
    this.controls.mouseButtons = { LEFT: dim === 2 ? MOUSE.PAN : MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.PAN };
    this.controls.touches = { ONE: dim === 2 ? TOUCH.PAN : TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN };
    this.controls.addEventListener("change", changed);
    this.controls.addEventListener("start", () => { this.moving = true; });
    this.controls.addEventListener("end", () => { this.moving = false; });
  }

  /** covered: pixels above and below in which other things lie, so that a shape in the plane is shown between them. */
  resize(width: number, height: number, covered = { above: 0, below: 0 }): void {
    this.width = width;
    this.height = height;
    // Where little is left the shape is shown below them.
    this.covered = covered.above + covered.below < 0.7 * height ? covered : { above: 0, below: 0 };
    if (this.camera instanceof PerspectiveCamera) this.camera.aspect = width / height;
    else this.frame(this.camera);
    this.camera.updateProjectionMatrix();
  }

  /** Shows all of a box. */
  fit(bounds: Bounds): void {
    const middle = bounds.middle(new Vector3());
    this.controls.target.copy(middle);
    if (this.camera instanceof PerspectiveCamera) this.back(this.camera, bounds);
    else {
      this.half.set(Math.max(bounds.width(0), 1e-9) / 2, Math.max(bounds.width(1), 1e-9) / 2).multiplyScalar(MARGIN);
      this.camera.zoom = 1;
      this.camera.position.set(middle.x, middle.y, middle.z + 2 * bounds.size());
      this.camera.near = 0;
      this.camera.far = 4 * bounds.size();
      this.frame(this.camera);
    }
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  private back(camera: PerspectiveCamera, bounds: Bounds): void {
    const radius = Math.max(0.5 * bounds.size(), 1e-9);
    const far = Math.max(SPARE * this.distance(camera, bounds), radius);
    camera.position.copy(this.controls.target).addScaledVector(FROM, far);
    camera.near = far / 100;
    camera.far = far * 20;
    this.controls.minDistance = radius / 50;
    this.controls.maxDistance = 10 * far;
  }

  /** How far from the middle of a box the camera sees all its corners. */
  private distance(camera: PerspectiveCamera, bounds: Bounds): number {
    const right = new Vector3().crossVectors(camera.up, FROM).normalize(), up = new Vector3().crossVectors(FROM, right);
    const slope = Math.tan((ANGLE * Math.PI) / 360), middle = bounds.middle(new Vector3());
    let far = 0;
    for (let corner = 0; corner < 8; corner += 1) {
      const at = new Vector3(...[0, 1, 2].map((k) => (corner & (1 << k) ? bounds.high : bounds.low)[k]!) as [number, number, number]).sub(middle);
      const aside = Math.max(Math.abs(at.dot(up)), Math.abs(at.dot(right)) / camera.aspect);
      far = Math.max(far, aside / slope + at.dot(FROM));
    }
    return far;
  }

  /** Keeps the same scale in both directions. */
  private frame(camera: OrthographicCamera): void {
    const { above, below } = this.covered, aside = above - below;
    const scale = Math.max(this.half.x / this.width, this.half.y / (this.height - above - below));
    camera.right = scale * this.width;
    camera.left = -camera.right;
    camera.top = scale * (this.height + aside);
    camera.bottom = scale * (aside - this.height);
  }

  /** Whether all corners of a box are in the picture; in the plane with room for the buttons at its sides. */
  shows(bounds: Bounds): boolean {
    const room = this.dim === 2 ? EDGE : 0;
    for (let corner = 0; corner < 8; corner += 1) {
      const [x, y, z] = [0, 1, 2].map((k) => (corner & (1 << k) ? bounds.high : bounds.low)[k]!) as [number, number, number];
      const at = this.toScreen(x, y, z, this.work);
      const far = Math.max(Math.abs(at.x / this.width - 0.5), Math.abs(at.y / this.height - 0.5));
      if (far > 0.5 - room) return false;
    }
    return true;
  }

  /** Pixels of a place, from the upper left of the canvas; z is less than 1 before the far end. */
  toScreen(x: number, y: number, z: number, to: Vector3): Vector3 {
    to.set(x, y, z).project(this.camera);
    return to.set((0.5 + 0.5 * to.x) * this.width, (0.5 - 0.5 * to.y) * this.height, to.z);
  }

  /** The ray through a pixel. */
  ray(x: number, y: number): Ray {
    const at = new Vector3((2 * x) / this.width - 1, 1 - (2 * y) / this.height, -1).unproject(this.camera);
    if (this.camera instanceof PerspectiveCamera) {
      return { origin: this.camera.position.clone(), direction: at.sub(this.camera.position).normalize() };
    }
    return { origin: at, direction: new Vector3(0, 0, -1) };
  }

  /** Metres in a pixel at a place. */
  pixel(at: Vector3): number {
    if (this.camera instanceof PerspectiveCamera) {
      const depth = this.work.copy(at).applyMatrix4(this.camera.matrixWorldInverse).z;
      return (2 * Math.abs(depth) * Math.tan((ANGLE * Math.PI) / 360)) / this.height;
    }
    return (this.camera.right - this.camera.left) / this.camera.zoom / this.width;
  }

  /** Goes along or around by pixels, as a hand on the picture would. */
  move(x: number, y: number): void {
    const right = new Vector3().setFromMatrixColumn(this.camera.matrix, 0);
    const up = new Vector3().setFromMatrixColumn(this.camera.matrix, 1);
    if (this.dim === 3) return this.around(-x / 200, -y / 200);
    const step = this.pixel(this.controls.target);
    const by = right.multiplyScalar(-x * step).addScaledVector(up, y * step);
    this.camera.position.add(by);
    this.controls.target.add(by);
    this.controls.update();
  }

  zoom(factor: number): void {
    if (this.camera instanceof PerspectiveCamera) {
      this.camera.position.sub(this.controls.target).divideScalar(factor).add(this.controls.target);
    } else {
      this.camera.zoom *= factor;
      this.camera.updateProjectionMatrix();
    }
    this.controls.update();
    this.controls.dispatchEvent({ type: "change" });
  }

  private around(azimuth: number, polar: number): void {
    const from = this.camera.position.clone().sub(this.controls.target);
    const length = from.length();
    const height = Math.min(Math.max(Math.acos(from.z / length) + polar, 0.02), Math.PI - 0.02);
    const turn = Math.atan2(from.y, from.x) + azimuth;
    from.set(Math.sin(height) * Math.cos(turn), Math.sin(height) * Math.sin(turn), Math.cos(height));
    this.camera.position.copy(this.controls.target).addScaledVector(from, length);
    this.controls.update();
  }

  dispose(): void { this.controls.dispose(); }
}
