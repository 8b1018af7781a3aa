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

/** Whether the browser has no graphics card, and WebGL computes each pixel by the processor; `?draw=card` says that it has. */
export function drawsInSoftware(context: WebGL2RenderingContext): boolean {
  const asked = new URLSearchParams(location.search).get("draw");
  if (asked) return asked !== "card";
  const names = context.getExtension("WEBGL_debug_renderer_info");
  const name: unknown = context.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER);
  return typeof name === "string" && SOFTWARE.test(name);
}
