// Elements of the page made in one expression, and text that is written only where it has changed.

type Attributes = Record<string, string | number | boolean | ((event: Event) => void)>;

/**
 * An element with attributes and children. A function is heard at the event that its key names; true is an attribute
 * without a value, and false is none.
 */
export function element<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag, attributes: Attributes = {}, ...children: (Node | string)[]
): HTMLElementTagNameMap[Tag] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(name, value);
    else if (value !== false) made.setAttribute(name, value === true ? "" : String(value));
  }
  made.append(...children);
  return made;
}

/** Text that changes often: the page is touched only where it reads differently. */
export class ChangingText {
  readonly node = document.createTextNode("");

  set(text: string): void {
    if (this.node.data !== text) this.node.data = text;
  }
}

/** Sets or removes an attribute, and touches the page only where that changes something. */
export function mark(of: Element, name: string, value: string | null): void {
  if (of.getAttribute(name) === value) return;
  if (value === null) of.removeAttribute(name);
  else of.setAttribute(name, value);
}

export function button(text: string, title: string, pressed: () => void): HTMLButtonElement {
  return element("button", { type: "button", title, click: pressed }, text);
}
