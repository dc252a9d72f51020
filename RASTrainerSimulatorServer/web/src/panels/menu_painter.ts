/** Paint a menu; where each of its items lies is returned, for pointing at it. */

import type { Fact, Item, Menu } from "../stream/messages";
import { COLORS, LINE, TONES, type Pen, type TextStyle } from "./pen";
import type { Region } from "./panel";

const PAD = 48;
const ROW = 68;
const GAP = 8;
const BAR = 10;
const FACT = 46;
const GAP_OF_FACT = 24;
const GAP_OF_VALUE = 32;
const PICTURE = 300;
const TITLE = { size: 52, color: COLORS.text, isBold: true };
const BODY = { size: 33, color: COLORS.soft };
/** Smaller where the choices would have no room. */
const BODY_SIZES = [33, 30, 27, 24];
/** How many choices are seen at least, if there are so many. */
const LEAST_ROWS = 4;
const GAP_OF_TEXT = 12;
const VALUE = { size: 34, color: COLORS.text, isBold: true };
const FACT_VALUE = { ...VALUE, size: 32 };
const LABEL = { size: 34, color: COLORS.text };
const PALE = { size: 34, color: COLORS.pale };
const HELP = { size: 29, color: COLORS.soft };

/** `image` is the plot of the menu, or the picture of the item that has the focus; null where there is none. */
export function paintMenu(
  pen: Pen,
  menu: Menu,
  width: number,
  height: number,
  hovered: string,
  image: HTMLImageElement | null,
): Region[] {
  const room = width - 2 * PAD;
  let y = PAD - 6;
  y += pen.paragraph(menu.title, PAD, y, TITLE, room) + 14;
  const help = menu.items.find((item) => item.name === menu.focus)?.help ?? "";
  const helpHeight = help === "" ? 0 : pen.wrapped(help, HELP, room).length * 38;
  const hasPicture = menu.trend !== null || menu.items.some((item) => item.picture !== "");
  const others =
    menu.facts.reduce((sum, fact) => sum + heightOf(pen, fact, room), 10) +
    (hasPicture ? PICTURE + GAP : 0) +
    Math.min(menu.items.length, LEAST_ROWS) * (ROW + GAP) +
    helpHeight;
  const body = bodyFor(pen, menu.paragraphs, room, height - y - others - PAD);
  for (const text of menu.paragraphs) y += pen.paragraph(text, PAD, y, body, room) + GAP_OF_TEXT;
  for (const fact of menu.facts) y += paintFact(pen, fact, y, width);
  y += 10;
  if (hasPicture) {
    if (image !== null) pen.picture(image, PAD, y, room, PICTURE);
    y += PICTURE + GAP;
  }
  const fitting = Math.floor((height - y - helpHeight - PAD + GAP) / (ROW + GAP));
  const regions: Region[] = [];
  const shown = aroundFocus(menu, Math.max(1, fitting));
  paintMore(pen, menu, shown, width - PAD / 2, y);
  for (const item of shown) {
    const isFocus = item.name === menu.focus;
    paintItem(pen, item, PAD, y, room, isFocus, item.name === hovered);
    if (item.is_enabled) regions.push({ name: item.name, x: PAD, y, width: room, height: ROW });
    y += ROW + GAP;
  }
  if (help !== "") y += pen.paragraph(help, PAD, y + 4, HELP, room);
  pen.behind(width, Math.min(height, y + PAD - 10), COLORS.night);
  return regions;
}

/** Return the largest style whose paragraphs leave room for the choices below them. */
function bodyFor(pen: Pen, paragraphs: readonly string[], room: number, height: number): TextStyle {
  const isLow = (style: TextStyle) =>
    paragraphs.reduce((sum, text) => sum + pen.wrapped(text, style, room).length * LINE * style.size + GAP_OF_TEXT, 0) <= height;
  const styles = BODY_SIZES.map((size) => ({ ...BODY, size }));
  return styles.find(isLow) ?? styles.at(-1)!;
}

/** Return the height of a label and its value, which take two lines where they do not fit in one. */
function heightOf(pen: Pen, fact: Fact, room: number): number {
  const isOneLine = pen.width(fact.label, BODY) + pen.width(fact.value, FACT_VALUE) + GAP_OF_FACT <= room;
  return isOneLine ? FACT : 2 * FACT - 8;
}

/** Paint a label and its value; return the height. */
function paintFact(pen: Pen, fact: Fact, top: number, width: number): number {
  const room = width - 2 * PAD;
  const value = { ...FACT_VALUE, color: fact.tone === "plain" ? COLORS.text : TONES[fact.tone] };
  const height = heightOf(pen, fact, room);
  pen.line(fact.label, PAD, top + FACT / 2, BODY, room);
  pen.lineTo(fact.value, width - PAD, top + height - FACT / 2, value);
  pen.box(PAD, top + height - 2, room, 2, COLORS.edge, 0);
  return height;
}

/** Return the items that fit, the focus among them. */
function aroundFocus(menu: Menu, most: number): readonly Item[] {
  if (menu.items.length <= most) return menu.items;
  const focus = Math.max(0, menu.items.findIndex((item) => item.name === menu.focus));
  const first = Math.min(menu.items.length - most, Math.max(0, focus - Math.floor(most / 2)));
  return menu.items.slice(first, first + most);
}

/** Mark by a bar beside the items in sight that there are others. */
function paintMore(pen: Pen, menu: Menu, shown: readonly Item[], middle: number, top: number): void {
  const count = menu.items.length;
  if (shown.length === count) return;
  const height = shown.length * (ROW + GAP) - GAP;
  const start = (height * menu.items.indexOf(shown[0]!)) / count;
  pen.box(middle - BAR / 2, top, BAR, height, COLORS.field, BAR / 2);
  pen.box(middle - BAR / 2, top + start, BAR, (height * shown.length) / count, COLORS.pale, BAR / 2);
}

function paintItem(
  pen: Pen,
  item: Item,
  x: number,
  y: number,
  width: number,
  isFocus: boolean,
  isHovered: boolean,
): void {
  pen.box(x, y, width, ROW, isFocus && item.is_enabled ? COLORS.accent : COLORS.row);
  if (isFocus || isHovered) pen.frame(x, y, width, ROW, COLORS.accentEdge);
  const middle = y + ROW / 2 + 2;
  const label = item.is_enabled ? LABEL : PALE;
  const value = item.kind === "choice" ? `◀ ${item.value} ▶` : item.value;
  if (item.kind === "axis") {
    const room = width - 350;
    pen.line(item.label, x + 26, middle, smaller(label, room / pen.width(item.label, label)), room);
    paintAxis(pen, Number(item.value), x + width - 300, middle);
  } else if (item.kind === "text") {
    pen.line(item.label, x + 26, middle, label, width - 420);
    pen.box(x + width - 380, y + 10, 360, ROW - 20, COLORS.field, 10);
    pen.line(value + (isFocus ? "▏" : ""), x + width - 366, middle, VALUE, 340);
  } else {
    const wide = pen.width(item.label, label) + pen.width(value, VALUE) + (value === "" ? 0 : GAP_OF_VALUE);
    const share = (width - 52) / wide;
    pen.line(item.label, x + 26, middle, smaller(label, share), width - 52);
    pen.lineTo(value, x + width - 26, middle, smaller(VALUE, share));
  }
}

/** Return a style that takes so much of its width, at most all: no word is lost for want of room. */
function smaller(style: TextStyle, share: number): TextStyle {
  return { ...style, size: Math.min(1, share) * style.size };
}

function paintAxis(pen: Pen, position: number, x: number, middle: number): void {
  pen.box(x, middle - 5, 270, 10, COLORS.field, 5);
  pen.box(x + 135 + 120 * (position || 0) - 13, middle - 13, 26, 26, TONES.plain, 13);
}
