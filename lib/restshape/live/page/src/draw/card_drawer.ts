// Draws by WebGL, which a graphics card carries out.

import { LinearSRGBColorSpace, WebGLRenderer, type Camera, type Color, type Object3D } from "three";

import type { Drawer } from "./drawer";
import { whatDraws } from "./drawn";

export class CardDrawer implements Drawer {
  readonly early = false;
  private readonly renderer: WebGLRenderer;

  /** Throws where the canvas has no WebGL 2. */
  constructor(readonly canvas: HTMLCanvasElement) {
    // An opaque canvas hides what is below it from the browser, which then need not draw that.
    const context = canvas.getContext("webgl2", { alpha: false, antialias: false, stencil: false, powerPreference: "high-performance" });
    if (!context) throw new Error("no WebGL 2");
    this.renderer = new WebGLRenderer({ canvas, context });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
  }

  resize(width: number, height: number, ratio: number): void {
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
  }

  clearTo(colour: Color): void { this.renderer.setClearColor(colour); }

  draw(scene: Object3D, camera: Camera): void {
    scene.traverseVisible((object) => whatDraws(object)?.ready());
    this.renderer.render(scene, camera);
  }
}
