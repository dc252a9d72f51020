/** The simulator's menu as a dialog of real controls: kept while they change, so that focus and caret stay. */

import type { Connection } from "../stream/connection";
import { element } from "../elements";
import { MenuRow } from "./menu_row";
import type { Fact, MenuItem, Menu } from "../generated";
import { say } from "../texts";

export class MenuView {
  private readonly clock = element("span", "", { className: "clock", role: "timer" });
  private readonly title = element("h2");
  private readonly text = element("div");
  private readonly list = element("ul");
  private readonly help = element("p", "", { className: "help" });
  /** Heard by screen readers when the focused item's value changes. */
  private readonly spoken = element("p", "", { className: "unseen", role: "status" });
  private readonly rows = new Map<string, MenuRow>();
  private shown = "";
  private shownText = "";
  private name = "";
  private shape = "";
  private focus = "";

  constructor(
    private readonly parent: HTMLElement,
    private readonly connection: Connection,
  ) {
    this.title.id = `${parent.id}-title`;
    this.text.id = `${parent.id}-text`;
    this.help.id = `${parent.id}-help`;
    this.parent.append(this.clock, this.title, this.text, this.list, this.help, this.spoken);
  }

  /** Show a menu, null for none; `drawn` is the address of the drawing that belongs to it, or "". */
  show(menu: Menu | null, drawn: string): void {
    const content = JSON.stringify([menu, drawn]);
    if (content === this.shown) return;
    this.shown = content;
    this.parent.hidden = menu === null;
    if (menu === null) this.clear();
    else this.fill(menu, drawn);
  }

  private clear(): void {
    this.name = this.shape = this.focus = "";
    this.rows.clear();
    this.list.replaceChildren();
  }

  private fill(menu: Menu, drawn: string): void {
    const focused = menu.items.find((item) => item.name === menu.focus);
    const drawnKind = menu.slices ? "menu pictured sliced" : "menu pictured";
    this.parent.className = drawn !== "" ? drawnKind : menu.facts.length > 0 ? "menu wide" : "menu";
    this.clock.textContent = menu.clock?.text ?? "";
    this.clock.dataset.tone = menu.clock?.tone ?? "plain";
    this.title.textContent = menu.title;
    this.fillText(menu, drawn, focused);
    const shape = JSON.stringify([menu.name, menu.items.map((item) => [item.name, item.kind])]);
    const isOther = shape !== this.shape;
    if (isOther) this.build(menu, shape);
    const before = this.rows.get(this.focus)?.spoken ?? "";
    for (const item of menu.items) this.rows.get(item.name)?.show(item, item.name === menu.focus);
    this.help.textContent = focused?.help ?? "";
    this.follow(menu.focus, isOther, before);
  }

  private fillText(menu: Menu, drawn: string, focused: MenuItem | undefined): void {
    const pictures = [drawn, focused?.picture ?? ""];
    const content = JSON.stringify([menu.paragraphs, menu.facts, pictures]);
    if (content === this.shownText) return;
    this.shownText = content;
    const parts: HTMLElement[] = menu.paragraphs.map((text) => element("p", text));
    if (drawn !== "") parts.unshift(picture(drawn, menu.trend?.text ?? menu.slices?.text ?? say("picture"), "drawn"));
    if (menu.facts.length > 0) parts.push(factsOf(menu.facts));
    if (focused?.picture) parts.push(picture(focused.picture, focused.label, "head"));
    this.text.replaceChildren(...parts);
  }

  /** Keep the rows that stay, in their places: a field that leaves the page for a moment loses its caret. */
  private build(menu: Menu, shape: string): void {
    const before = menu.name === this.name ? new Map(this.rows) : new Map<string, MenuRow>();
    if (menu.name !== this.name) this.list.scrollTop = 0;
    this.shape = shape;
    this.name = menu.name;
    this.rows.clear();
    for (const item of menu.items) {
      const kept = before.get(item.name);
      const row = kept?.kind === item.kind ? kept : new MenuRow(item, this.help.id, this.connection);
      this.rows.set(item.name, row);
    }
    const lines = [...this.rows.values()].map((row) => row.line);
    for (const line of [...this.list.children]) if (!lines.includes(line as HTMLLIElement)) line.remove();
    let place = this.list.firstElementChild;
    for (const line of lines) {
      if (line === place) place = place.nextElementSibling;
      else this.list.insertBefore(line, place);
    }
  }

  /** Have the browser's focus go where the simulator's is, unless a person has taken it out of the menu. */
  private follow(focus: string, isOther: boolean, before: string): void {
    const row = this.rows.get(focus);
    const now = row?.spoken ?? "";
    if (focus === this.focus && !isOther) {
      if (now !== before) this.spoken.textContent = now;
      return;
    }
    this.focus = focus;
    this.spoken.textContent = "";
    const active = document.activeElement;
    if (isOther || active === null || active === document.body || this.parent.contains(active)) row?.takeFocus();
    // The last menu may have been scrolled down: a title is seen wherever the focus leaves room.
    if (isOther) this.parent.scrollTop = 0;
    // The help covers the end of a list that is scrolled.
    this.parent.style.scrollPaddingBottom = `${this.help.offsetHeight}px`;
    this.parent.style.scrollPaddingTop = `${this.title.offsetHeight}px`;
    row?.line.scrollIntoView({ block: "nearest" });
  }
}

function factsOf(facts: readonly Fact[]): HTMLElement {
  const table = element("dl");
  for (const fact of facts) {
    const value = element("dd", fact.value);
    value.dataset.tone = fact.tone;
    const line = element("div", "");
    line.append(element("dt", fact.label), value);
    table.append(line);
  }
  return table;
}

function picture(source: string, name: string, kind: string): HTMLImageElement {
  return element("img", "", { className: kind, src: source, alt: name });
}
