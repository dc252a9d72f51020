/** One item of a menu: a button, a field or a meter, with the name that a screen reader says. */

import type { Connection } from "../stream/connection";
import { element } from "../elements";
import { MAX_ITEM_TEXT, type MenuItem } from "../generated";

/** Typed text that has not come back from the simulator for so long was refused. */
const ANSWER_MS = 1000;

export class MenuRow {
  readonly line = element("li");
  private readonly label = element("span");
  private readonly value: HTMLElement;
  /** The element that takes the focus; a meter cannot. */
  private readonly control: HTMLButtonElement | HTMLInputElement | null;
  private item: MenuItem;
  private typed = -Infinity;
  /** Whether the focus comes from the simulator, which then need not hear of it. */
  private isFollowing = false;

  constructor(
    item: MenuItem,
    helpId: string,
    private readonly connection: Connection,
  ) {
    this.item = item;
    this.line.dataset.name = item.name;
    this.line.dataset.kind = item.kind;
    if (item.kind === "axis") {
      this.control = null;
      this.value = element("meter", "", { min: -1, max: 1 });
      this.line.append(this.label, this.value);
    } else if (item.kind === "text") {
      this.value = this.control = this.field();
      const label = element("label");
      label.append(this.label, this.value);
      this.line.append(label);
    } else {
      this.value = element("b");
      this.control = this.button();
      this.line.append(this.control);
    }
    this.control?.setAttribute("aria-describedby", helpId);
  }

  show(item: MenuItem, hasFocus: boolean): void {
    this.item = item;
    this.label.textContent = item.label;
    this.line.toggleAttribute("data-focus", hasFocus);
    if (this.control !== null) {
      this.control.setAttribute("aria-disabled", String(!item.isEnabled));
      this.control.tabIndex = hasFocus ? 0 : -1;
    }
    if (this.value instanceof HTMLInputElement) {
      this.value.readOnly = !item.isEnabled;
      this.showText(this.value);
    } else if (this.value instanceof HTMLMeterElement) {
      this.value.value = Number(item.value) || 0;
      this.value.ariaLabel = item.label;
    } else this.value.textContent = item.value;
  }

  get kind(): MenuItem["kind"] {
    return this.item.kind;
  }

  /** Text for screen readers. */
  get spoken(): string {
    return `${this.item.label} ${this.item.value}`.trim();
  }

  takeFocus(): void {
    this.isFollowing = true;
    this.control?.focus({ preventScroll: true });
    this.isFollowing = false;
  }

  private button(): HTMLButtonElement {
    const button = element("button", "", { type: "button" });
    // A space apart, or names would be read as one word with their values.
    button.append(this.label, " ", this.value);
    button.onclick = () => {
      if (this.item.isEnabled) this.connection.send({ type: "item", name: this.item.name });
    };
    return button;
  }

  private field(): HTMLInputElement {
    const field = element("input", "", { maxLength: MAX_ITEM_TEXT, autocomplete: "off", spellcheck: false });
    field.oninput = () => this.tell(field);
    field.onfocus = () => {
      // Typing replaces the present ID. A click would put the cursor into it after this.
      window.setTimeout(() => field.select());
      if (!this.isFollowing) this.tell(field);
    };
    return field;
  }

  private tell(field: HTMLInputElement): void {
    this.typed = performance.now();
    this.connection.send({ type: "text", name: this.item.name, value: field.value });
    window.setTimeout(() => this.showText(field), ANSWER_MS);
  }

  private showText(field: HTMLInputElement): void {
    const isAwaited = performance.now() - this.typed < ANSWER_MS - 1;
    if (!isAwaited && field.value !== this.item.value) field.value = this.item.value;
  }
}
