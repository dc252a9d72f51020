/** The simulator's screen over a flat picture: each part is rebuilt when it has changed. */

import { ACROSS, BESIDE } from "../scene/flat_view";
import type { Connection } from "../stream/connection";
import { byId } from "../elements";
import { MenuView } from "./menu_view";
import { factLines, hintLine, message } from "./parts";
import type { ControlNews, Menu, ScreenMessage, PairingNews, Screen } from "../generated";
import { controlsPicture, inputsOf } from "../panels/controls_picture";
import { plotOf } from "../panels/slices_plot";
import { say, sayHolder, type TextName } from "../texts";

/** Caption of the inset. */
const INSETS: Readonly<Record<string, TextName>> = { "close-up": "closeUp", [BESIDE]: "beside", [ACROSS]: "across" };

export class Overlay {
  private readonly shown = new Map<string, string>();
  /** The page's own sentence in place of the simulator's warnings; "" for none. */
  private notice: TextName | "" = "";
  private control: ControlNews | null = null;
  private screen: Screen | null = null;
  private pairing: PairingNews | null = null;
  private readonly menuView: MenuView;

  constructor(private readonly connection: Connection) {
    this.menuView = new MenuView(byId("menu"), connection);
  }

  show(screen: Screen): void {
    const { connection } = this;
    document.body.dataset.menu = screen.menu?.name ?? "";
    this.screen = screen;
    this.showMenu(screen.menu);
    this.part("instruction", screen.instruction, (parent) => message(screen.instruction, parent));
    this.showFacts();
    const choose = (item: string) => connection.send({ type: "item", name: item });
    this.part("hints", screen.hints, (parent) => parent.append(...screen.hints.map((hint) => hintLine(hint, choose))));
    this.showWarnings();
  }

  showControl(control: ControlNews): void {
    this.control = control;
    this.sayControl();
  }

  /** Write the page's own permanent texts in the present language. */
  label(): void {
    this.sayControl();
    this.showFacts();
    this.showWarnings();
  }

  /** Show above each menu how to pair another view. */
  showPairing(pairing: PairingNews): void {
    this.pairing = pairing;
    this.showFacts();
  }

  /** Say something of the page's own until it is called off by "". */
  setNotice(name: TextName | ""): void {
    this.notice = name;
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
    frame.dataset.name = say(INSETS[name] ?? "far");
  }

  private sayControl(): void {
    const { control } = this;
    if (control === null) return;
    const place = byId("control");
    place.textContent = sayHolder(control.holder, control.isYou);
    place.dataset.holder = control.holder;
  }

  private showWarnings(): void {
    const own: ScreenMessage[] = this.notice === "" ? [] : [{ text: say(this.notice), tone: "error" }];
    const all = [...own, ...(this.screen?.warnings ?? [])].slice(0, 3);
    this.part("warnings", all, (parent) => parent.append(...all.map((warning) => message(warning))));
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
    const { pairing, screen } = this;
    const coverage = screen?.coverage ?? "";
    const isTold = pairing !== null && screen?.menu != null;
    const how = isTold ? [say("pairing", { code: pairing.code, address: pairing.addresses[1] ?? pairing.addresses[0]! })] : [];
    const facts = [...(screen?.status ?? []), ...how];
    this.part("status", [facts, coverage], (parent) => parent.append(...factLines(facts, coverage)));
  }

  private showMenu(menu: Menu | null): void {
    const plot = menu === null ? "" : plotOf(menu);
    this.menuView.show(menu, menu?.picture ? controlsPicture(menu.picture, inputsOf(menu)) : plot);
  }
}
