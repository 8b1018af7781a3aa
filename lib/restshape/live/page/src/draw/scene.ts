// The picture: what frames bring is drawn once, when something has changed.

import { ColorManagement, Group, Scene as Drawn } from "three";

import type { App, Frame, Look, Welcome } from "../app";
import type { Painter } from "../panels/painter";
import type { FieldInfo } from "../protocol";
import { Ahead } from "./ahead";
import { CardDrawer } from "./card_drawer";
import { chosenMap, ends } from "./colour_maps";
import { ColourBar } from "./colour_bar";
import type { Drawer, Means } from "./drawer";
import { Labels, type Word } from "./labels";
import { Marks, type ArrowsDrawn, type LinesDrawn } from "./marks";
import { Parts } from "./parts";
import { autoScale, largest } from "./scale";
import { Shared } from "./shared";
import { Sharpness } from "./sharpness";
import { SoftwareDrawer } from "./software_drawer";
import { Theme } from "./theme";
import { View } from "./view";

ColorManagement.enabled = false; // colours of maps are shown as they are

export class Scene {
  readonly theme = new Theme();
  readonly shared = new Shared();
  readonly labels: Labels;
  readonly marks: Marks;
  readonly overlay = new Group();                    // of the hand: what lights up
  parts: Parts;
  view: View;
  onDraw: (() => void)[] = [];                       // before a drawing
  private drawer: Drawer;
  private readonly scene = new Drawn();
  private readonly group = new Group();
  private readonly bar: ColourBar;
  private field: FieldInfo | null = null;
  private said = { scale: 1, text: "" };
  private asked = false;
  private stale = true;                              // what is to be seen is not drawn yet
  private readonly ahead = new Ahead();
  private readonly sharpness = new Sharpness(() => this.sharpen());
  private answered = 0;
  private fitted = false;
  private whole = true;                              // all was in the picture
  private looked = false;                            // somebody has moved the picture since
  left = 0;                                          // of the canvas in the window, pixels
  top = 0;
  private width = 1;
  private height = 1;

  /** Throws where the browser lacks the means. */
  constructor(
    private readonly app: App, readonly canvas: HTMLCanvasElement, labels: HTMLElement, bar: HTMLElement,
    private readonly painter: Painter, private readonly means: Means,
  ) {
    this.drawer = means === "card" ? new CardDrawer(canvas) : new SoftwareDrawer(canvas, this.shared, false, means);
    this.labels = new Labels(labels, painter, () => this.request());
    this.bar = new ColourBar(bar, painter);
    this.marks = new Marks(this.scene, this.shared, this.theme, this.labels, () => this.request());
    this.scene.add(this.group, this.overlay);
    this.parts = new Parts(this.group, this.shared, this.theme, 2);
    this.view = new View(canvas, 2, () => this.moved());
    this.theme.onChange(() => this.recolour());
    this.recolour();
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener("pointerenter", () => this.locate());
    canvas.addEventListener("pointerdown", () => this.locate(), { capture: true });
    canvas.addEventListener("webglcontextrestored", () => this.request());
    app.on("welcome", (welcome) => this.begin(welcome));
    app.on("frame", (frame) => this.take(frame));
    app.on("look", (look) => this.restyle(look));
  }

  setLines(name: string, lines: LinesDrawn | null): void { this.marks.setLines(name, lines); }
  setArrows(name: string, arrows: ArrowsDrawn | null): void { this.marks.setArrows(name, arrows, this.size); }
  setWords(name: string, words: readonly Word[] | null): void { this.marks.setWords(name, words); }

  /** Size of the scene [m]. */
  get size(): number { return this.parts.bounds.size() || 1; }

  /** Draws once, at the browser's next turn. */
  request(): void {
    this.stale = true;
    if (this.asked) return;
    this.asked = true;
    this.sharpness.request(performance.now());
    requestAnimationFrame(() => this.draw());
  }

  fit(): void {
    this.parts.measure();
    const bounds = this.parts.drawnBox();
    if (bounds.empty) return;
    this.view.fit(bounds);
    [this.whole, this.looked] = [true, false];
    this.request();
  }

  /** The picture as it is now, drawn at once so that its pixels can be read. */
  pixels(): HTMLCanvasElement {
    this.sharpness.settle();
    this.painter.now();
    this.drawer.draw(this.scene, this.view.camera);
    return this.canvas;
  }

  private begin(welcome: Welcome): void {
    const same = this.view.dim === welcome.dim && this.fitted;
    this.parts.clear();
    if (!same) {
      this.view.dispose();
      this.view = new View(this.canvas, welcome.dim, () => this.moved());
      this.parts = new Parts(this.group, this.shared, this.theme, welcome.dim);
      this.fitted = false;
      if (this.means !== "card") this.drawer = new SoftwareDrawer(this.canvas, this.shared, welcome.dim === 3, this.means);
      this.recolour();
      this.resize();
    }
    this.shared.scale.value = 1;
    this.field = null;
    if (welcome.things.some(({ role }) => role === "plank")) this.app.changeLook({ wireframe: false });
    this.request();
  }

  private take({ header, read }: Frame): void {
    this.parts.update(header.parts, read);
    this.leaveOut(this.app.look);
    for (const part of header.parts) this.nameField(part.field);
    this.answered = Math.max(this.answered, header.id);
    if (this.fitted) this.follow();
    else this.first();
    this.colour();
    this.request();
    // Once all have taken the frame.
    if (this.drawer.early && this.ahead.wants()) queueMicrotask(() => this.paint());
  }

  private paint(): void {
    if (!this.stale) return;
    const begun = performance.now();
    for (const before of this.onDraw) before();
    this.drawer.draw(this.scene, this.view.camera);
    this.sharpness.took(performance.now() - begun);
    this.stale = false;
  }

  /** What all was in the picture, and grows out of it, is shown again; not while a hand drags, nor after a look at a part. */
  private follow(): void {
    this.rescale();
    if (this.app.held || this.view.moving) return;
    const bounds = this.parts.drawnBox();
    if (bounds.empty) return;
    const shown = this.view.shows(bounds);
    if (this.whole && !shown && !this.looked) this.fit();
    else this.whole = shown;
    this.looked = false;
  }

  private moved(): void {
    this.looked = true;
    this.request();
  }

  /** Of the first frame all is shown. */
  private first(): void {
    if (!this.parts.all.size) return;
    this.fitted = true;
    this.parts.measure();
    this.rescale();
    this.fit();
  }

  private nameField(name: string | undefined): void {
    if (name) this.field = this.app.welcome?.fields.find((field) => field.name === name) ?? this.field;
  }

  private restyle(look: Look): void {
    this.shared.wires = look.wireframe;
    for (const surface of this.parts.surfaces()) surface.setWired();
    this.leaveOut(look);
    this.rescale();
    this.colour();
    this.request();
  }

  /** Hides what is not to be seen. */
  private leaveOut(look: Look): void {
    for (const { lines, dots, part } of this.parts.all.values()) {
      if (part.role !== "outline") continue;
      if (lines) lines.mesh.visible = look.rest && !lines.empty;
      if (dots) dots.points.visible = look.handles && !dots.empty;
    }
  }

  private rescale(): void {
    const { look, welcome } = this.app;
    const before = this.shared.scale.value;
    let scale = look.scale;
    // Beside where it should be a shape is drawn where it is.
    const exact = welcome?.trueScale || welcome?.goals || this.app.things.some(({ role }) => role === "plank");
    if (look.autoScale) scale = exact ? 1 : autoScale(before, this.largest(), this.size);
    if (scale === before) return;
    this.shared.scale.value = scale;
    this.app.tell("scaled", scale);
    for (const surface of this.parts.surfaces()) surface.turnNormals();
  }

  private largest(): number {
    let most = 0;
    for (const surface of this.parts.surfaces()) most = Math.max(most, largest(surface.shifts));
    return most;
  }

  private colour(): void {
    const { look } = this.app;
    let low = Infinity;
    let high = -Infinity;
    for (const surface of this.parts.surfaces()) {
      surface.setColoured(look.colours !== "none");
      if (!surface.hasValues) continue;
      low = Math.min(low, surface.low);
      high = Math.max(high, surface.high);
    }
    const { signed, fromZero } = this.field ?? { signed: false, fromZero: false };
    const span = look.range ?? ends(low, high, signed, fromZero);
    const map = chosenMap(look.colours, signed);
    this.shared.ends.value.set(...span);
    this.shared.colours(map);
    const known = low <= high && look.colours !== "none" ? this.field : null;
    this.bar.show({ field: known, map, ends: span, low, high, note: this.deformation() });
  }

  private deformation(): string {
    let any = false;
    for (const surface of this.parts.surfaces()) any ||= surface.hasShifts;
    const scale = this.shared.scale.value;
    if (!any) return "";
    const mode = this.parts.mode();
    if (mode) return `mode ${mode} drawn at ${Number(((100 * scale * this.largest()) / this.size).toPrecision(2))} % of the size`;
    if (scale === 1) return "";
    if (scale !== this.said.scale) this.said = { scale, text: `displacements × ${scale.toLocaleString("en")}` };
    return this.said.text;
  }

  private recolour(): void {
    this.drawer.clearTo(this.theme.colour("ground"));
    this.shared.glowing.value = this.theme.colour("lit");
    this.request();
  }

  private locate(): void {
    const { left, top } = this.canvas.getBoundingClientRect();
    this.left = left;
    this.top = top;
  }

  private resize(): void {
    this.locate();
    const { clientWidth, clientHeight } = this.canvas;
    this.width = Math.max(clientWidth, 1);
    this.height = Math.max(clientHeight, 1);
    this.view.resize(this.width, this.height, this.covered());
    this.grain();
    this.stale = true;
    this.draw();
  }

  /** Pixels of a narrow picture that the tools above and the colours below take. */
  private covered(): { above: number; below: number } {
    const tools = document.getElementById("tools"), foot = document.getElementById("foot");
    if (!tools || !foot || getComputedStyle(foot).position !== "absolute") return { above: 0, below: 0 };
    const { top, bottom } = this.canvas.getBoundingClientRect();
    return { above: Math.max(tools.getBoundingClientRect().bottom - top, 0), below: Math.max(bottom - foot.getBoundingClientRect().top, 0) };
  }

  /** Takes as many pixels as the picture has now. */
  private grain(): void {
    const ratio = Math.min(devicePixelRatio || 1, 2) * this.sharpness.share;
    this.drawer.resize(this.width, this.height, ratio);
    this.shared.size.value.set(this.width * ratio, this.height * ratio);
    this.shared.pixels.value = ratio;
  }

  private sharpen(): void {
    this.grain();
    this.request();
  }

  private draw(): void {
    if (this.asked) this.sharpness.begin(performance.now(), this.answered > 0 || this.view.moving);
    this.asked = false;
    this.ahead.turn();
    this.paint();
    // In a drag words stay beside their places.
    this.labels.place(this.view, this.width, this.height, this.shared.scale.value, this.app.held ? [] : this.parts.handles(this.view));
    if (this.answered) this.app.tell("drawn", this.answered);
    this.answered = 0;
  }
}
