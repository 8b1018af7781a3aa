// How the picture comes onto its canvas: by a graphics card, or without one.

import type { Camera, Color, Object3D } from "three";

export interface Drawer {
  /** Drawing takes the page's time: it is done as soon as there is something to draw, not when the display is about to show it. */
  readonly early: boolean;
  /** Width and height [pixels of the page], and how many of the canvas are in one of the page. */
  resize(width: number, height: number, ratio: number): void;
  clearTo(colour: Color): void;
  draw(scene: Object3D, camera: Camera): void;
}

const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** By what the picture is drawn: a graphics card, or the processor; that can ask for WebGL in software, or has none. */
export type Means = "card" | "processor" | "processor alone";

/** By what this browser draws; `?draw=card` and `?draw=processor` choose. null: by nothing. */
export function meansOf(): Means | null {
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) return document.createElement("canvas").getContext("2d") ? "processor alone" : null;
  const asked = new URLSearchParams(location.search).get("draw");
  const found = asked === "card" || (!asked && !drawsInSoftware(context)) ? "card" : "processor";
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return found;
}

/** Whether the browser has no graphics card, and WebGL computes each pixel by the processor. */
function drawsInSoftware(context: WebGL2RenderingContext): boolean {
  const names = context.getExtension("WEBGL_debug_renderer_info");
  const name: unknown = context.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER);
  return typeof name === "string" && SOFTWARE.test(name);
}
