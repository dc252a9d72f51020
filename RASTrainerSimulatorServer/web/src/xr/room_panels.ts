/** The panels in the room: menus in front of the eyes, facts for the work next to the head, warnings above it. */

import { Group, Vector3 } from "three";

import { element } from "../elements";
import type { ControlNews, DepthRuler, GuideAim, Screen, ScreenMessage } from "../generated";
import { GuidingPanel } from "../panels/guiding_panel";
import { MenuView } from "../overlay/menu_view";
import { factLines, hintLine, message } from "../overlay/parts";
import { controlsPicture, inputsOf, PICTURE_HEIGHT, PICTURE_WIDTH } from "../panels/controls_picture";
import { ElementPanel } from "../panels/element_panel";
import { Panel } from "../panels/panel";
import { plotOf } from "../panels/slices_plot";
import type { Connection } from "../stream/connection";
import { say, sayHolder } from "../texts";
import { CloseUp } from "./close_up";

/** Where a panel stands: right of the head's direction and above the eyes (rad), and away (m). */
interface Seat {
  readonly aside: number;
  readonly above: number;
  readonly away: number;
}
/** In front of the eyes, and nearer than the arm. */
const MENU: Seat = { aside: 0, above: -0.06, away: 0.55 };
const ACTIONS: Seat = { aside: 0, above: 0.43, away: 0.55 };
/** Next to the drawing of the controls, which belongs to it. */
const MENU_ASIDE = 0.41;
const PICTURE: Seat = { aside: -0.4, above: 0, away: 0.55 };
const WORK: Seat = { aside: 0.6, above: 0.05, away: 1.1 };
/** Like a picture on the table next to the head, where the arm seldom covers it. */
const CLOSE_UP: Seat = { aside: 0.72, above: -0.5, away: 0.85 };
/** Stands between the head and the close-up, below the facts for the work. */
const GUIDING: Seat = { aside: 0.24, above: -0.42, away: 0.85 };
/** Places of the warning: below a menu; while the arm is driven, above the head, covering no point of it. */
const WARNING_AT_MENU: Seat = { aside: 0, above: -0.54, away: 0.55 };
const WARNING_AWAY = 1;
const WARNING_OVER_HEAD = 0.2;
const HEAD_ABOVE_M = 0.16;
/** Widths, m, where a panel is so far away; a nearer one is as much smaller. */
const FULL_SIZE_AWAY = 1.1;
const WIDE = 0.86;
const PICTURE_WIDE = 0.8;
const CLOSE_UP_WIDE = 0.72;
const WARNING_WIDE = 0.66;
const GUIDING_WIDE = 0.24;
/** Order of drawing; what points at a panel comes after it. */
const ON_TOP = 10;

/** A turn or a move of the person beyond which the panels come after them. */
const TURN_RAD = 0.6;
const MOVE_M = 0.25;
/** So near above the head there is no way toward it; then the panels stand where the eyes look. */
const NEAREST_M = 0.15;

/** Names of what the headset does itself; an item of a menu never has such a name. */
export const LOCAL = ["recenter", "higher", "lower", "grab", "leave"] as const;
export type Local = (typeof LOCAL)[number];
const PREFIX = "local ";
const PAD = 40;

export class RoomPanels {
  /** In the room. */
  readonly room = new Group();
  readonly closeUp = new CloseUp(CLOSE_UP_WIDE);
  private readonly menu = new ElementPanel(1024, 1024, WIDE);
  private readonly work = new ElementPanel(1024, 760, WIDE);
  private readonly actions = new ElementPanel(1024, 236, WIDE);
  private readonly picture = new ElementPanel(PICTURE_WIDTH + 2 * PAD, PICTURE_HEIGHT + 2 * PAD, PICTURE_WIDE);
  private readonly warning = new ElementPanel(1024, 256, WARNING_WIDE);
  private readonly aim = new GuidingPanel(element("canvas"));
  private readonly guiding = new Panel(this.aim.canvas, GUIDING_WIDE);
  private readonly menuView: MenuView;
  private readonly drawing = new Image();
  private screen: Screen | null = null;
  /** The eyes for which the panels stand, the level unit vector to their middle, and the middle of the patient's head. */
  private readonly eyes = new Vector3();
  private readonly ahead = new Vector3(0, 0, -1);
  private readonly focus = new Vector3();
  private wasMenu = false;
  private control: ControlNews | null = null;
  private notice = "";
  private mayGrab = true;

  constructor(connection: Connection) {
    const { menu, work, actions, picture, warning, guiding, closeUp } = this;
    this.room.add(...[menu, work, actions, picture, warning, guiding].map((panel) => panel.mesh), closeUp.mesh);
    for (const [order, panel] of [menu, actions, picture, warning, guiding].entries()) {
      // The arm may stand before them.
      panel.mesh.material.depthTest = false;
      panel.mesh.renderOrder = ON_TOP + order;
    }
    const section = element("section");
    section.id = "room-menu";
    menu.root.append(section);
    this.menuView = new MenuView(section, connection);
    picture.root.append(part("div", "drawing", this.drawing));
  }

  /** Those that can be pointed at. */
  get pointable(): readonly ElementPanel[] {
    return [this.menu, this.actions];
  }

  /** Those that tracked hands, which have no buttons, can point at. */
  get touchable(): readonly ElementPanel[] {
    return [...this.pointable, this.work];
  }

  /** Whether sticks step: through a menu, or through a trial that is shown again. */
  get sticksNavigate(): boolean {
    return this.screen !== null && (this.screen.menu !== null || this.screen.sticksNavigate);
  }

  /** Whether a menu is open. */
  get isMenu(): boolean {
    return this.screen?.menu != null;
  }

  /** Stand for eyes at a place, regardless of the person's earlier moves. */
  put(eyes: Vector3, ahead: Vector3, focus: Vector3): void {
    this.eyes.copy(eyes);
    this.ahead.copy(ahead);
    this.focus.copy(focus);
    this.arrange();
  }

  /**
   * Follow the person's eyes and their level `gaze`, but not each small move.
   * Menus come up in the line of sight; facts for the work stand around the head.
   */
  follow(eyes: Vector3, gaze: Vector3): void {
    const toHead = this.focus.clone().sub(eyes).setY(0);
    const wanted = this.isMenu || toHead.length() < NEAREST_M ? gaze : toHead.normalize();
    const hasTurned = wanted.angleTo(this.ahead) > TURN_RAD;
    if (this.isMenu === this.wasMenu && !hasTurned && eyes.distanceTo(this.eyes) <= MOVE_M) return;
    this.wasMenu = this.isMenu;
    this.put(eyes, wanted, this.focus);
  }

  /** Place the panels where the person reads them well. */
  private arrange(): void {
    const aside = this.screen?.menu?.picture ? MENU_ASIDE : 0;
    const { eyes, focus } = this;
    const top = Math.atan2(focus.y + HEAD_ABOVE_M - eyes.y, Math.hypot(focus.x - eyes.x, focus.z - eyes.z));
    const overHead = { aside: 0, above: top + WARNING_OVER_HEAD, away: WARNING_AWAY };
    const { menu, actions, picture, work, closeUp, warning, guiding } = this;
    const side = sideWithoutRobot(this.eyes, this.ahead);
    const seats = [
      [menu, { ...MENU, aside }],
      [actions, { ...ACTIONS, aside }],
      [picture, PICTURE],
      [work, { ...WORK, aside: side * WORK.aside }],
      [closeUp, { ...CLOSE_UP, aside: side * CLOSE_UP.aside }],
      [guiding, { ...GUIDING, aside: side * GUIDING.aside }],
      [warning, this.isMenu ? WARNING_AT_MENU : overHead],
    ] as const;
    for (const [{ mesh }, seat] of seats) {
      const toPanel = mesh.position.copy(this.ahead).applyAxisAngle(UP, -seat.aside);
      toPanel.multiplyScalar(seat.away * Math.cos(seat.above)).setY(seat.away * Math.sin(seat.above));
      toPanel.add(eyes);
      mesh.scale.setScalar(seat.away / FULL_SIZE_AWAY);
      mesh.lookAt(eyes);
    }
  }

  show(screen: Screen): void {
    this.screen = screen;
    this.arrange();
    this.paint();
  }

  showControl(control: ControlNews): void {
    this.control = control;
    this.paint();
  }

  /** Show the bull's-eye or the depth ruler, if there is one. */
  showGuiding(aim: GuideAim | null, ruler: DepthRuler | null, depth: number): void {
    this.guiding.mesh.visible = aim !== null || ruler !== null;
    if (this.aim.show(aim, ruler, depth)) this.guiding.texture.needsUpdate = true;
  }

  setNotice(text: string): void {
    this.notice = text;
    this.paint();
  }

  hover(name: string): void {
    for (const panel of this.touchable) panel.hover(name);
  }

  /** Scroll the menu if that is what the part of a panel is for; return whether it is. */
  scroll(name: string): boolean {
    return this.menu.scroll(name);
  }

  setGrab(mayGrab: boolean): void {
    this.mayGrab = mayGrab;
    this.paint();
  }

  /** Return the panel's action of this name, null for an item of the menu. */
  localAction(name: string): Local | null {
    return LOCAL.find((action) => PREFIX + action === name) ?? null;
  }

  dispose(): void {
    for (const panel of [this.menu, this.work, this.actions, this.picture, this.warning, this.guiding]) panel.dispose();
    this.closeUp.dispose();
    this.room.removeFromParent();
  }

  private paint(): void {
    const { screen } = this;
    if (screen === null) return;
    const { menu } = screen;
    const holder = part("p", "control", sayHolder(this.control?.holder ?? "", this.control?.isYou ?? false));
    this.closeUp.mesh.visible = menu === null;
    if (menu !== null) {
      this.menuView.show(menu, plotOf(menu));
      const buttons = LOCAL.map((action) => this.button(action));
      this.actions.root.replaceChildren(part("div", "actions", ...buttons, holder));
      if (menu.picture) this.drawing.src = controlsPicture(menu.picture, inputsOf(menu));
    } else {
      this.work.root.replaceChildren(workOf(screen, holder));
    }
    const own: ScreenMessage[] = this.notice === "" ? [] : [{ text: this.notice, tone: "error" }];
    const first = [...own, ...screen.warnings.filter(isUrgent)].slice(0, 1);
    this.warning.root.replaceChildren(part("ul", "warnings", ...first.map((one) => message(one))));
    for (const [panel, isShown] of [
      [this.menu, menu !== null],
      [this.actions, menu !== null],
      [this.picture, Boolean(menu?.picture)],
      [this.work, menu === null],
      [this.warning, first.length > 0],
    ] as const) {
      if (isShown) panel.update();
      panel.show(isShown);
    }
  }

  private button(action: Local): HTMLElement {
    const button = element("button", say(action === "grab" && !this.mayGrab ? "noGrab" : action));
    button.dataset.name = PREFIX + action;
    return button;
  }
}

/** Return the text for driving the arm: the instruction, short facts and the controls. */
function workOf(screen: Screen, holder: HTMLElement): HTMLElement {
  const plain = screen.warnings.filter((warning) => !isUrgent(warning)).slice(0, 2);
  const instruction = message(screen.instruction, part("p", "instruction"));
  return part(
    "div",
    "work",
    instruction,
    part("ul", "warnings", ...plain.map((one) => message(one))),
    part("ul", "status", ...factLines(screen.status, screen.coverage)),
    part("ul", "hints", ...screen.hints.map((hint) => hintLine(hint, () => undefined))),
    holder,
  );
}

function part(tag: "div" | "p" | "ul", name: string, ...content: (Node | string)[]): HTMLElement {
  const made = element(tag, "");
  made.className = name;
  made.append(...content);
  return made;
}

function isUrgent(message: ScreenMessage): boolean {
  return message.tone === "warning" || message.tone === "error";
}

/** Return 1 if the robot, which stands at the origin, is to the left of the line of sight, else −1. */
function sideWithoutRobot(eyes: Vector3, ahead: Vector3): number {
  return ahead.z * eyes.x - ahead.x * eyes.z <= 0 ? 1 : -1;
}

const UP = new Vector3(0, 1, 0);
