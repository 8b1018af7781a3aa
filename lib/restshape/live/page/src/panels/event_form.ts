// A form for one event, made from its JSON schema.

import type { ScriptEvent } from "../protocol";
import { button, element } from "./element";
import { exampleOf, fieldsOf, type FieldShape } from "./schema_fields";
import { pointText, TypedError, valueOf } from "./typed_values";

export interface FormNeeds {
  /** Names that can be typed where an entity is asked for, and keys of numbers. */
  lists: { names: string; keys: string };            // ids of datalists
  pick(what: string): Promise<number[] | null>;
  send(event: ScriptEvent): void;
}

type Control = HTMLInputElement | HTMLSelectElement;

const HINTS: Partial<Record<FieldShape["kind"], string>> = {
  point: "x, y", points: "x, y; x, y; …", pins: "vertex; x, y; …", any: "number, text or JSON",
};

export class EventForm {
  readonly body: HTMLFormElement;
  private readonly controls = new Map<FieldShape, Control>();
  private readonly wrong = element("p", { class: "wrong", role: "alert", hidden: true });

  constructor(private readonly name: string, schema: object, private readonly needs: FormNeeds) {
    const lines = fieldsOf(schema).map((field) => this.line(field));
    this.body = element("form", { class: "event", autocomplete: "off", novalidate: true },
      ...lines, this.wrong, element("button", { type: "submit" }, name));
    this.body.addEventListener("submit", (event) => {
      event.preventDefault();
      this.send();
    });
  }

  /** Writes into the first field that takes a name, unless something is there that the user has typed. */
  suggest(name: string): void {
    for (const [field, control] of this.controls) {
      if (field.kind === "name" && field.name === "on" && !control.dataset["typed"]) control.value = name;
    }
  }

  private send(): void {
    const event: ScriptEvent = { do: this.name };
    this.wrong.hidden = true;
    for (const [field, control] of this.controls) {
      control.removeAttribute("aria-invalid");
      try {
        const value = valueOf(field, control.value);
        if (value !== undefined) event[field.name] = value;
      } catch (error) {
        if (!(error instanceof TypedError)) throw error;
        this.wrong.textContent = error.message;
        this.wrong.hidden = false;
        control.setAttribute("aria-invalid", "true");
        control.focus();
        return;
      }
    }
    this.needs.send(event);
  }

  private line(field: FieldShape): HTMLElement {
    const control = this.control(field);
    control.addEventListener("input", () => { control.dataset["typed"] = control.value; });
    this.controls.set(field, control);
    const label = element("label", { title: field.help }, element("span", {}, field.required ? field.name : `${field.name} (optional)`), control);
    const picks = field.kind === "point" || field.kind === "points" || field.kind === "pins";
    return picks ? element("div", { class: "pickable" }, label, this.picker(field, control)) : label;
  }

  private control(field: FieldShape): Control {
    if (field.kind === "choice" || field.kind === "yes") {
      const choices = field.kind === "yes" ? ["true", "false"] : field.choices;
      const made = element("select", {}, ...(field.required ? [] : [element("option", { value: "" }, field.otherwise ? `(${field.otherwise})` : "–")]),
        ...choices.map((choice) => element("option", { value: choice }, field.kind === "yes" ? { true: "yes", false: "no" }[choice]! : choice)));
      return made;
    }
    const hint = field.kind === "quantity" ? exampleOf(field) : HINTS[field.kind] ?? "";
    const made = element("input", { type: "text", placeholder: field.otherwise || hint, spellcheck: false });
    if (field.required) made.setAttribute("aria-required", "true");
    if (field.kind === "point" && field.least > 2) made.placeholder = "x, y, z";
    if (field.kind === "number" || field.kind === "whole") made.inputMode = field.kind === "whole" ? "numeric" : "decimal";
    if (field.kind === "name") made.setAttribute("list", this.needs.lists.names);
    if (field.kind === "key") made.setAttribute("list", this.needs.lists.keys);
    return made;
  }

  /** Fills a point in from the canvas; a list of points grows by one with each press until Escape. */
  private picker(field: FieldShape, control: Control): HTMLButtonElement {
    const take = async () => {
      const one = field.kind === "point";
      do {
        const place = await this.needs.pick(`${this.name}: ${field.name}`);
        if (!place) return;
        const text = pointText(place, field.most);
        control.value = one || !control.value.trim() ? text : `${control.value}; ${text}`;
        control.dataset["typed"] = control.value;
      } while (!one && this.body.isConnected);
    };
    return button("pick", `press the shape where ${field.name} is${field.kind === "point" ? "" : "; Escape ends"}`, () => void take());
  }
}
