/** The simulator's screen over a flat picture: each part is made anew when it has changed. */

import { BESIDE } from "./flat_view";
import type { Connection } from "./connection";
import type { ControlNews, Item, Menu, Message, PairingNews, Screen } from "./messages";
import { controlsPicture, inputsOf } from "./panels/controls_picture";
import { trendPlot } from "./panels/trend_plot";
import { say, sayHolder } from "./texts";

export class Overlay {
  private readonly shown = new Map<string, string>();
  /** What the page says itself in place of the simulator's warnings; "" for nothing. */
  private notice = "";
  private warnings: readonly Message[] = [];
  private menu: Menu | null = null;
  private holder = "";
  private facts: readonly string[] = [];
  private pairing: PairingNews | null = null;

  constructor(private readonly connection: Connection) {}

  show(screen: Screen): void {
    document.body.dataset.menu = screen.menu?.name ?? "";
    this.menu = screen.menu;
    this.showMenu();
    this.part("instruction", screen.instruction, (parent) => {
      parent.textContent = screen.instruction.text;
      parent.dataset.tone = screen.instruction.tone;
    });
    this.facts = screen.status;
    this.showFacts();
    this.part("hints", screen.hints, (parent) => {
      for (const hint of screen.hints) {
        const line = element("li", "");
        line.append(element("kbd", hint.control), hint.action);
        parent.append(line);
      }
    });
    this.warnings = screen.warnings;
    this.showWarnings();
  }

  showControl(control: ControlNews): void {
    const place = byId("control");
    place.textContent = sayHolder(control.holder, control.isYou);
    place.dataset.holder = control.holder;
    this.holder = control.holder;
    this.showMenu();
  }

  /** Tell beside each menu how another view is paired. */
  showPairing(pairing: PairingNews): void {
    this.pairing = pairing;
    this.showFacts();
  }

  /** Say something of the page's own until it is called off by "". */
  setNotice(text: string): void {
    this.notice = text;
    this.showWarnings();
  }

  /** Frame the picture in red while a touch goes wrong. */
  showError(isError: boolean): void {
    byId("contact").hidden = !isError;
  }

  /** Frame the small picture of the camera that does not fill the window. */
  showInset(name: string): void {
    const frame = byId("inset");
    frame.hidden = name === "";
    frame.dataset.name = say(name === "close-up" ? "closeUp" : name === BESIDE ? "beside" : "far");
  }

  private showWarnings(): void {
    const own: Message[] = this.notice === "" ? [] : [{ text: this.notice, tone: "error" }];
    const all = [...own, ...this.warnings].slice(0, 3);
    this.part("warnings", all, (parent) => {
      for (const warning of all) {
        const line = element("li", warning.text);
        line.dataset.tone = warning.tone;
        parent.append(line);
      }
    });
  }

  private part(id: string, content: unknown, fill: (parent: HTMLElement) => void): void {
    const text = JSON.stringify(content);
    if (this.shown.get(id) === text) return;
    this.shown.set(id, text);
    const parent = byId(id);
    parent.replaceChildren();
    fill(parent);
  }

  private showFacts(): void {
    const { pairing } = this;
    const isTold = pairing !== null && this.menu !== null;
    const how = isTold ? [say("pairing", { code: pairing.code, address: pairing.addresses[1] ?? pairing.addresses[0]! })] : [];
    const facts = [...this.facts, ...how];
    this.part("status", facts, (parent) => parent.append(...facts.map((fact) => element("li", fact))));
  }

  private showMenu(): void {
    const { menu } = this;
    let drawn = menu?.picture === "controls" ? controlsPicture(this.holder, inputsOf(menu)) : "";
    if (menu?.trend) drawn = trendPlot(menu.trend);
    this.part("menu", [menu, drawn], (parent) => this.fillMenu(parent, menu, drawn));
  }

  private fillMenu(parent: HTMLElement, menu: Menu | null, drawn: string): void {
    parent.hidden = menu === null;
    if (menu === null) return;
    parent.className = drawn !== "" ? "pictured" : menu.facts.length > 0 ? "wide" : "";
    if (drawn !== "") parent.append(drawing(drawn, menu.trend?.text ?? say("picture")));
    parent.append(element("h1", menu.title));
    parent.append(...menu.paragraphs.map((text) => element("p", text)));
    if (menu.facts.length > 0) parent.append(factsOf(menu));
    const focused = menu.items.find((item) => item.name === menu.focus);
    if (focused?.picture) parent.append(picture(focused));
    const list = element("ul", "");
    list.setAttribute("role", "listbox");
    list.append(...menu.items.map((item) => this.line(item, item.name === menu.focus)));
    parent.append(list);
    const help = element("p", focused?.help ?? "");
    help.className = "help";
    parent.append(help);
    // The last menu may have been scrolled down: a title is seen wherever the focus leaves room.
    parent.scrollTop = 0;
    list.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" });
  }

  private line(item: Item, hasFocus: boolean): HTMLElement {
    const line = element("li", item.label);
    line.setAttribute("role", "option");
    line.setAttribute("aria-selected", String(hasFocus));
    line.setAttribute("aria-disabled", String(!item.is_enabled));
    line.dataset.name = item.name;
    line.dataset.kind = item.kind;
    if (item.kind === "axis") line.append(axis(Number(item.value)));
    else if (item.kind !== "button" || item.value !== "") line.append(element("b", item.value));
    line.onclick = () => {
      if (item.is_enabled) this.connection.send("item", { name: item.name });
    };
    return line;
  }
}

export function byId(id: string): HTMLElement {
  return document.getElementById(id)!;
}

function element(tag: string, text: string): HTMLElement {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}

function drawing(source: string, name: string): HTMLImageElement {
  const image = new Image();
  image.src = source;
  image.alt = name;
  return image;
}

function factsOf(menu: Menu): HTMLElement {
  const table = element("dl", "");
  for (const fact of menu.facts) {
    const value = element("dd", fact.value);
    value.dataset.tone = fact.tone;
    table.append(element("dt", fact.label), value);
  }
  return table;
}

function picture(item: Item): HTMLImageElement {
  const image = document.createElement("img");
  image.className = "head";
  image.src = item.picture;
  image.alt = item.label;
  return image;
}

function axis(position: number): HTMLMeterElement {
  const meter = document.createElement("meter");
  meter.min = -1;
  meter.max = 1;
  meter.value = Number.isFinite(position) ? position : 0;
  return meter;
}
