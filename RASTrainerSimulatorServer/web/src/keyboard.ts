/** The keys, told to the simulator as they are; it knows what each does. */

import type { Connection } from "./connection";

/** These stay the browser's own. */
const BROWSERS = new Set(["F3", "F5", "F6", "F11", "F12", "MetaLeft", "MetaRight", "AltLeft"]);
const LONGEST_TEXT = 16;

export class Keyboard {
  private readonly held = new Set<string>();

  constructor(private readonly connection: Connection) {
    window.addEventListener("keydown", (event) => this.press(event));
    window.addEventListener("keyup", (event) => this.release(event.code));
    // Its release will go to another window: the arm must not run on.
    window.addEventListener("blur", () => this.releaseAll());
    document.addEventListener("visibilitychange", () => this.releaseAll());
  }

  get isHolding(): boolean {
    return this.held.size > 0;
  }

  private press(event: KeyboardEvent): void {
    const isForBrowser = event.ctrlKey || event.metaKey || event.altKey;
    const isTyping = event.target instanceof HTMLInputElement;
    if (isForBrowser || isTyping || event.code === "" || BROWSERS.has(event.code)) return;
    const isOfPage = event.target instanceof HTMLButtonElement && event.code === "Tab";
    if (!isOfPage) event.preventDefault();
    this.held.add(event.code);
    const text = event.key.length <= 2 ? event.key.slice(0, LONGEST_TEXT) : "";
    this.connection.send("key", { code: event.code, isDown: true, text });
  }

  private release(code: string): void {
    if (!this.held.delete(code)) return;
    this.connection.send("key", { code, isDown: false, text: "" });
  }

  private releaseAll(): void {
    for (const code of [...this.held]) this.release(code);
  }
}
