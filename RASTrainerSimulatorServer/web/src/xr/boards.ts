/** The panels in the room: what is read stands beside the head, warnings go with the eyes. */

import { Group, Vector3, type Object3D } from "three";

import type { ControlNews, Menu, Message, Screen } from "../messages";
import { Board, type Region } from "../panels/board";
import { paintMenu } from "../panels/menu_painter";
import { controlsPicture, inputsOf, PICTURE_HEIGHT, PICTURE_WIDTH } from "../panels/controls_picture";
import { BANNERS, COLORS, type Pen } from "../panels/pen";
import { paintWork } from "../panels/work_painter";
import { say, sayHolder, type TextName } from "../texts";
import { trendPlot } from "../panels/trend_plot";
import { thumbnail } from "../thumbnails";
import { CloseUp } from "./close_up";
import type { Placement } from "./placement";

/** Where a board stands: right of the head's direction and above the eyes (rad), and away (m). */
interface Seat {
  readonly aside: number;
  readonly above: number;
  readonly away: number;
}
const MENU: Seat = { aside: 0.6, above: -0.06, away: 1.1 };
const ACTIONS: Seat = { aside: 0.6, above: 0.43, away: 1.1 };
const PICTURE: Seat = { aside: -0.22, above: 0.2, away: 1.1 };
const WORK: Seat = { aside: 0.6, above: 0.16, away: 1.1 };
/** Like a picture that lies on the table beside the head: the arm is seldom before it. */
const CLOSE_UP: Seat = { aside: 0.72, above: -0.5, away: 0.85 };
const WIDE = 0.86;
const PICTURE_WIDE = 0.8;
const CLOSE_UP_WIDE = 0.56;
const WARNING_AWAY = 1.0;
const WARNING_BELOW = 0.2;
const BUTTON = { size: 32, color: COLORS.text, isBold: true };
const WARNING = { size: 40, color: COLORS.text, isBold: true };

/** Names of what the headset does itself; an item of a menu never has such a name. */
export const LOCAL = ["recenter", "higher", "lower", "grab", "leave"] as const;
export type Local = (typeof LOCAL)[number];
const PREFIX = "local ";
const PAD = 40;

export class Boards {
  /** In the room. */
  readonly room = new Group();
  readonly closeUp = new CloseUp(CLOSE_UP_WIDE);
  private readonly menu = new Board(1024, 1024, WIDE);
  private readonly work = new Board(1024, 560, WIDE);
  private readonly actions = new Board(1024, 236, WIDE);
  private readonly picture = new Board(PICTURE_WIDTH + 2 * PAD, PICTURE_HEIGHT + 2 * PAD, PICTURE_WIDE);
  /** What is drawn on `picture`; it is there a moment later than its address. */
  private readonly drawing = new Image();
  private readonly warning = new Board(1024, 256, 0.6);
  private screen: Screen | null = null;
  private control: ControlNews | null = null;
  private notice = "";
  private hovered = "";
  private mayGrab = true;

  constructor(eyes: Object3D) {
    const boards = [this.menu, this.work, this.actions, this.picture];
    this.room.add(...boards.map((board) => board.mesh), this.closeUp.mesh);
    this.drawing.onload = () => this.paint();
    this.warning.mesh.position.set(0, -WARNING_BELOW, -WARNING_AWAY);
    this.warning.mesh.renderOrder = 10;
    this.warning.mesh.material.depthTest = false;
    eyes.add(this.warning.mesh);
  }

  /** Those that can be pointed at. */
  get pointable(): readonly Board[] {
    return [this.menu, this.actions];
  }

  /** Whether sticks step: through a menu, or through a trial that is shown again. */
  get isStepped(): boolean {
    return this.screen !== null && (this.screen.menu !== null || this.screen.is_stepped);
  }

  /** Stand where somebody at the place of the eyes reads them well. */
  arrange(placement: Placement): void {
    const { menu, actions, picture, work, closeUp } = this;
    const seats = [[menu, MENU], [actions, ACTIONS], [picture, PICTURE], [work, WORK], [closeUp, CLOSE_UP]] as const;
    for (const [{ mesh }, seat] of seats) {
      const toBoard = mesh.position.copy(placement.forward).applyAxisAngle(UP, -seat.aside);
      toBoard.multiplyScalar(seat.away * Math.cos(seat.above)).setY(seat.away * Math.sin(seat.above));
      toBoard.add(placement.eyes);
      mesh.lookAt(placement.eyes);
    }
  }

  show(screen: Screen): void {
    this.screen = screen;
    this.paint();
  }

  showControl(control: ControlNews): void {
    this.control = control;
    this.paint();
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
    for (const board of [this.menu, this.work, this.actions, this.picture, this.warning]) board.dispose();
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
      this.work.show(JSON.stringify([read, holder]), (pen) =>
        paintWork(pen, read, holder, this.work.width, this.work.height),
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
    const own: Message[] = this.notice === "" ? [] : [{ text: this.notice, tone: "error" }];
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

function isUrgent(message: Message): boolean {
  return message.tone === "warning" || message.tone === "error";
}

const UP = new Vector3(0, 1, 0);
