/** The keys, sent to the simulator as they are; it knows what each does. */

import { MAX_KEY_TEXT } from "../generated";
import { keyNames, learnKeyName, readKeyNames } from "../key_names";
import type { Connection } from "../stream/connection";

/** These stay the browser's own. */
const BROWSERS = new Set(["F3", "F5", "F6", "F11", "F12", "MetaLeft", "MetaRight", "AltLeft", "Tab"]);
/** A field's actions for keys that type nothing. */
const EDITS = new Set(["Backspace", "Delete", "ArrowLeft", "ArrowRight", "Home", "End"]);
const PRESSES = new Set(["Enter", "NumpadEnter", "Space"]);

export class Keyboard {
  private readonly held = new Set<string>();

  constructor(private readonly connection: Connection) {
    window.addEventListener("keydown", (event) => this.press(event));
    window.addEventListener("keyup", (event) => {
      // Some browsers press a button only when the key comes up.
      if (this.held.has(event.code)) event.preventDefault();
      this.release(event.code);
    });
    // Its release will go to another window: the arm must not run on.
    window.addEventListener("blur", () => this.releaseAll());
    document.addEventListener("visibilitychange", () => this.releaseAll());
  }

  get isHolding(): boolean {
    return this.held.size > 0;
  }

  /** Report the keys' labels, as far as they are known. */
  async tellNames(): Promise<void> {
    await readKeyNames();
    this.connection.send({ type: "layout", keys: keyNames() });
  }

  private press(event: KeyboardEvent): void {
    if (this.connection.isWatching) return;
    const isForBrowser = event.ctrlKey || event.metaKey || event.altKey;
    if (isForBrowser || event.code === "" || BROWSERS.has(event.code) || isOfElement(event)) return;
    event.preventDefault();
    if (learnKeyName(event)) this.connection.send({ type: "layout", keys: keyNames() });
    this.held.add(event.code);
    const text = event.key.length <= 2 ? event.key.slice(0, MAX_KEY_TEXT) : "";
    this.connection.send({ type: "key", code: event.code, isDown: true, text });
  }

  private release(code: string): void {
    if (!this.held.delete(code)) return;
    this.connection.send({ type: "key", code, isDown: false, text: "" });
  }

  private releaseAll(): void {
    for (const code of [...this.held]) this.release(code);
  }
}

/** Tell whether a key is for the field or the button that has the focus. */
function isOfElement({ target, key, code }: KeyboardEvent): boolean {
  if (target instanceof HTMLInputElement) {
    const isInMenu = target.closest("#menu") !== null;
    return !isInMenu || [...key].length === 1 || EDITS.has(key) || key === "Process" || key === "Dead";
  }
  // The simulator presses the button that has its focus: it knows that the keyboard did.
  return target instanceof HTMLButtonElement && PRESSES.has(code) && target.closest("[data-focus]") === null;
}
