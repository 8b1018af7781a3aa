// The picture as a PNG file: what is drawn, its words, and its colours with their values.

import type { Scene } from "./scene";

export async function savePicture(scene: Scene, name: string): Promise<void> {
  const picture = composed(scene);
  const blob = await new Promise<Blob | null>((then) => { picture.toBlob(then, "image/png"); });
  if (blob) download(blob, `${name}.png`);
}

/** Hands a file to the browser. */
export function download(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

function composed(scene: Scene): HTMLCanvasElement {
  const from = scene.pixels();
  const picture = document.createElement("canvas");
  picture.width = from.width;
  picture.height = from.height;
  const pen = picture.getContext("2d")!;
  pen.drawImage(from, 0, 0);
  const ratio = from.width / from.clientWidth;
  pen.scale(ratio, ratio);
  const origin = from.getBoundingClientRect();
  for (const text of document.querySelectorAll<HTMLElement>("#labels span, #legend li, #bar figcaption, #bar .scale span, #bar .extremes")) {
    write(pen, text, origin);
  }
  const strip = document.querySelector<HTMLCanvasElement>("#bar canvas");
  if (strip?.offsetParent) {
    const { left, top, width, height } = strip.getBoundingClientRect();
    pen.drawImage(strip, left - origin.left, top - origin.top, width, height);
  }
  return picture;
}

function write(pen: CanvasRenderingContext2D, text: HTMLElement, origin: DOMRect): void {
  const style = getComputedStyle(text);
  if (style.visibility === "hidden" || !text.offsetParent || !text.textContent) return;
  const { left, top, width, height } = text.getBoundingClientRect();
  pen.fillStyle = style.backgroundColor;
  pen.fillRect(left - origin.left, top - origin.top, width, height);
  pen.font = `${style.fontSize} ${style.fontFamily}`;
  pen.fillStyle = style.color;
  pen.textBaseline = "middle";
  const lines = text.textContent.split("\n"), tall = height / lines.length;
  lines.forEach((line, i) => pen.fillText(line, left - origin.left + parseFloat(style.paddingLeft), top - origin.top + (i + 0.5) * tall));
}
