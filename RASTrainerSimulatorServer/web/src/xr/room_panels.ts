/** The panels in the room: menus before the eyes, what is read at work beside the head, warnings above it. */

import { Group, Vector3 } from "three";

import { BANNERS, type GuideAim, type ControlNews, type DepthRuler, type Menu, type ScreenMessage, type Screen } from "../generated";
import { Panel, type Region } from "../panels/panel";
import { GUIDING_HEIGHT, GUIDING_WIDTH, guidingContent, paintGuiding } from "../panels/guiding_painter";
import { paintMenu } from "../panels/menu_painter";
import { controlsPicture, inputsOf, PICTURE_HEIGHT, PICTURE_WIDTH } from "../panels/controls_picture";
import { COLORS, type Pen } from "../panels/pen";
import { paintWork } from "../panels/work_painter";
import { say, sayHolder, type TextName } from "../texts";
import { trendPlot } from "../panels/trend_plot";
import { thumbnail } from "../panels/thumbnails";
import { CloseUp } from "./close_up";
import type { Seating } from "./seating";

/** Where a panel stands: right of the head's direction and above the eyes (rad), and away (m). */
interface Seat {
  readonly aside: number;
  readonly above: number;
  readonly away: number;
}
/** In front of the eyes, and nearer than the arm. */
const MENU: Seat = { aside: 0, above: -0.06, away: 0.55 };
const ACTIONS: Seat = { aside: 0, above: 0.43, away: 0.55 };
/** Beside the drawing of the controls, which belongs to it. */
const MENU_ASIDE = 0.41;
const PICTURE: Seat = { aside: -0.4, above: 0, away: 0.55 };
const WORK: Seat = { aside: 0.6, above: 0.05, away: 1.1 };
/** Like a picture that lies on the table beside the head: the arm is seldom before it. */
const CLOSE_UP: Seat = { aside: 0.72, above: -0.5, away: 0.85 };
/** Between the head and the close-up, below what is read at work. */
const GUIDING: Seat = { aside: 0.24, above: -0.42, away: 0.85 };
/** Below a menu. While the arm is driven, so far above the head's top that no point of it is covered. */
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
const BUTTON = { size: 32, color: COLORS.text, isBold: true };
const WARNING = { size: 40, color: COLORS.text, isBold: true };

/** Names of what the headset does itself; an item of a menu never has such a name. */
export const LOCAL = ["recenter", "higher", "lower", "grab", "leave"] as const;
export type Local = (typeof LOCAL)[number];
const PREFIX = "local ";
const PAD = 40;

export class RoomPanels {
  /** In the room. */
  readonly room = new Group();
  readonly closeUp = new CloseUp(CLOSE_UP_WIDE);
  private readonly menu = new Panel(1024, 1024, WIDE);
  private readonly work = new Panel(1024, 760, WIDE);
  private readonly actions = new Panel(1024, 236, WIDE);
  private readonly picture = new Panel(PICTURE_WIDTH + 2 * PAD, PICTURE_HEIGHT + 2 * PAD, PICTURE_WIDE);
  /** What is drawn on `picture`; it is there a moment later than its address. */
  private readonly drawing = new Image();
  private readonly warning = new Panel(1024, 256, WARNING_WIDE);
  private readonly guiding = new Panel(GUIDING_WIDTH, GUIDING_HEIGHT, GUIDING_WIDE);
  private screen: Screen | null = null;
  private seating: Seating | null = null;
  private control: ControlNews | null = null;
  private notice = "";
  private hovered = "";
  private mayGrab = true;

  constructor() {
    const panels = [this.menu, this.work, this.actions, this.picture, this.warning, this.guiding];
    this.guiding.mesh.visible = false;
    this.room.add(...panels.map((panel) => panel.mesh), this.closeUp.mesh);
    this.drawing.onload = () => this.paint();
    const before = [this.menu, this.actions, this.picture, this.warning, this.guiding];
    for (const [order, panel] of before.entries()) {
      // The arm may stand before them.
      panel.mesh.material.depthTest = false;
      panel.mesh.renderOrder = ON_TOP + order;
    }
  }

  /** Those that can be pointed at. */
  get pointable(): readonly Panel[] {
    return [this.menu, this.actions];
  }

  /** Those that tracked hands, which have no buttons, can point at. */
  get touchable(): readonly Panel[] {
    return [...this.pointable, this.work];
  }

  /** Whether sticks step: through a menu, or through a trial that is shown again. */
  get isStepped(): boolean {
    return this.screen !== null && (this.screen.menu !== null || this.screen.sticksNavigate);
  }

  /** Whether a menu is open. */
  get isMenu(): boolean {
    return this.screen?.menu != null;
  }

  /** Place the panels where a person seated like this reads them well. */
  arrange(seating: Seating): void {
    this.seating = seating;
    const aside = this.screen?.menu?.picture ? MENU_ASIDE : 0;
    const { eyes, focus } = seating;
    const top = Math.atan2(focus.y + HEAD_ABOVE_M - eyes.y, Math.hypot(focus.x - eyes.x, focus.z - eyes.z));
    const overHead = { aside: 0, above: top + WARNING_OVER_HEAD, away: WARNING_AWAY };
    const { menu, actions, picture, work, closeUp, warning, guiding } = this;
    const side = sideWithoutRobot(seating);
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
      const toPanel = mesh.position.copy(seating.ahead).applyAxisAngle(UP, -seat.aside);
      toPanel.multiplyScalar(seat.away * Math.cos(seat.above)).setY(seat.away * Math.sin(seat.above));
      toPanel.add(eyes);
      mesh.scale.setScalar(seat.away / FULL_SIZE_AWAY);
      mesh.lookAt(eyes);
    }
  }

  show(screen: Screen): void {
    this.screen = screen;
    if (this.seating !== null) this.arrange(this.seating);
    this.paint();
  }

  showControl(control: ControlNews): void {
    this.control = control;
    this.paint();
  }

  /** Show the bull's-eye or the depth ruler; nothing where there is neither. */
  showGuiding(aim: GuideAim | null, ruler: DepthRuler | null, depth: number): void {
    const { guiding } = this;
    guiding.mesh.visible = aim !== null || ruler !== null;
    if (guiding.mesh.visible) guiding.show(guidingContent(aim, ruler, depth), (pen) => paintGuiding(pen, aim, ruler, depth));
  }

  setNotice(text: string): void {
    this.notice = text;
    this.paint();
  }

  hover(name: string): void {
    this.hovered = name;
    this.paint();
  }

  setGrab(mayGrab: boolean): void {
    this.mayGrab = mayGrab;
    this.paint();
  }

  /** Return which of its own actions a chosen name is, null for an item of the menu. */
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
    const holder = sayHolder(this.control?.holder ?? "", this.control?.isYou ?? false);
    this.menu.mesh.visible = this.actions.mesh.visible = menu !== null;
    this.work.mesh.visible = this.closeUp.mesh.visible = menu === null;
    this.paintPicture(menu);
    if (menu !== null) {
      const focused = menu.items.find((item) => item.name === menu.focus);
      const image = thumbnail(menu.trend ? trendPlot(menu.trend) : (focused?.picture ?? ""), () => this.paint());
      this.menu.show(JSON.stringify([menu, this.hovered, image !== null]), (pen) =>
        paintMenu(pen, menu, this.menu.width, this.menu.height, this.hovered, image),
      );
      const content = JSON.stringify([this.hovered, this.mayGrab, holder, screen.language]);
      this.actions.show(content, (pen) => this.paintActions(pen, holder));
    } else {
      const plain = screen.warnings.filter((warning) => !isUrgent(warning));
      const read = { ...screen, warnings: plain };
      this.work.show(JSON.stringify([read, holder, this.hovered]), (pen) =>
        paintWork(pen, read, holder, this.work.width, this.work.height, this.hovered),
      );
    }
    this.paintWarning(screen);
  }

  private paintPicture(menu: Menu | null): void {
    const { drawing, picture } = this;
    const isWanted = Boolean(menu?.picture);
    if (menu?.picture) {
      const source = controlsPicture(menu.picture, inputsOf(menu));
      if (drawing.src !== source) drawing.src = source;
    }
    picture.mesh.visible = isWanted && drawing.complete;
    if (!picture.mesh.visible) return;
    picture.show(drawing.src, (pen) => {
      pen.box(0, 0, picture.width, picture.height, COLORS.night, PAD);
      pen.image(drawing, PAD, PAD);
    });
  }

  private paintWarning(screen: Screen): void {
    const own: ScreenMessage[] = this.notice === "" ? [] : [{ text: this.notice, tone: "error" }];
    const first = [...own, ...screen.warnings.filter(isUrgent)][0];
    this.warning.mesh.visible = first !== undefined;
    if (first === undefined) return;
    const { width } = this.warning;
    this.warning.show(JSON.stringify(first), (pen) => {
      const lines = Math.min(4, pen.wrapped(first.text, WARNING, width - 80).length);
      pen.box(0, 0, width, lines * 51 + 48, BANNERS[first.tone], 28);
      pen.paragraph(first.text, 40, 24, WARNING, width - 80);
    });
  }

  private paintActions(pen: Pen, holder: string): Region[] {
    const { width, height } = this.actions;
    pen.box(0, 0, width, height, COLORS.night, 40);
    const labels: readonly TextName[] = ["recenter", "higher", "lower", this.mayGrab ? "grab" : "noGrab", "leave"];
    const regions: Region[] = [];
    let x = 32;
    let y = 20;
    LOCAL.forEach((action, index) => {
      const name = PREFIX + action;
      const text = say(labels[index]!);
      const wide = pen.width(text, BUTTON) + 44;
      if (x + wide > width - 24) {
        x = 32;
        y += 74;
      }
      pen.box(x, y, wide, 62, name === this.hovered ? COLORS.accent : COLORS.row, 16);
      pen.line(text, x + 22, y + 33, BUTTON);
      regions.push({ name, x, y, width: wide, height: 62 });
      x += wide + 14;
    });
    pen.line(holder, 32, height - 38, { size: 32, color: COLORS.soft }, width - 64);
    return regions;
  }
}

function isUrgent(message: ScreenMessage): boolean {
  return message.tone === "warning" || message.tone === "error";
}

/** Return 1 where the robot, which stands at the origin, is left of what is looked at, else −1. */
function sideWithoutRobot({ eyes, ahead }: Seating): number {
  return ahead.z * eyes.x - ahead.x * eyes.z <= 0 ? 1 : -1;
}

const UP = new Vector3(0, 1, 0);
