/** Paint a menu; where each of its items lies is returned, for pointing at it. */

import { TONES, type Fact, type MenuItem, type Menu } from "../generated";
import { COLORS, LINE, type Pen, type TextStyle } from "./pen";
import type { Region } from "./panel";

const PAD = 48;
const TOP = 42;
const ROW = 68;
const GAP = 8;
const BAR = 10;
const GAP_OF_FACT = 24;
const GAP_OF_VALUE = 32;
const PICTURE = 300;
/** Of paragraphs and labels, and with them title and values: smaller where the choices would have no room. */
const SIZES = [33, 30, 27, 24] as const;
/** How many choices are seen at least, if there are so many. */
const LEAST_ROWS = 4;
const GAP_OF_TITLE = 14;
const GAP_OF_TEXT = 12;
const GAP_OF_FACTS = 10;
const VALUE = { size: 34, color: COLORS.text, isBold: true };
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
  const help = menu.items.find((item) => item.name === menu.focus)?.help ?? "";
  const helpHeight = help === "" ? 0 : pen.wrapped(help, HELP, room).length * 38;
  const hasPicture = menu.trend !== null || menu.items.some((item) => item.picture !== "");
  const below = (hasPicture ? PICTURE + GAP : 0) + Math.min(menu.items.length, LEAST_ROWS) * (ROW + GAP) + helpHeight + PAD;
  const styles = SIZES.map(stylesOf);
  const style = styles.find((each) => heightAbove(pen, menu, each, room) + below <= height) ?? styles.at(-1)!;
  let y = TOP;
  y += pen.paragraph(menu.title, PAD, y, style.title, room) + GAP_OF_TITLE;
  for (const text of menu.paragraphs) y += pen.paragraph(text, PAD, y, style.body, room) + GAP_OF_TEXT;
  for (const fact of menu.facts) y += paintFact(pen, fact, y, width, style);
  y += GAP_OF_FACTS;
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
    if (item.isEnabled) regions.push({ name: item.name, x: PAD, y, width: room, height: ROW });
    y += ROW + GAP;
  }
  if (help !== "") y += pen.paragraph(help, PAD, y + 4, HELP, room);
  pen.behind(width, Math.min(height, y + PAD - 10), COLORS.night);
  return regions;
}

/** What is above the choices, in one size. */
interface Styles {
  readonly title: TextStyle;
  readonly body: TextStyle;
  readonly value: TextStyle;
  /** Height of a label with its value in one line, and of both in two. */
  readonly fact: readonly [number, number];
}

function stylesOf(size: number): Styles {
  const share = size / SIZES[0];
  return {
    title: { size: share * 52, color: COLORS.text, isBold: true },
    body: { size, color: COLORS.soft },
    value: { ...VALUE, size: Math.max(SIZES.at(-1)!, share * 32) },
    fact: [share * 46, share * 84],
  };
}

/** Return the height of what is above picture and choices. */
function heightAbove(pen: Pen, menu: Menu, style: Styles, room: number): number {
  const high = (text: string, of: TextStyle) => pen.wrapped(text, of, room).length * LINE * of.size;
  return [
    TOP + high(menu.title, style.title) + GAP_OF_TITLE,
    ...menu.paragraphs.map((text) => high(text, style.body) + GAP_OF_TEXT),
    ...menu.facts.map((fact) => heightOf(pen, fact, room, style)),
    GAP_OF_FACTS,
  ].reduce((sum, part) => sum + part);
}

/** Return the height of a label and its value, which take two lines where they do not fit in one. */
function heightOf(pen: Pen, fact: Fact, room: number, { body, value, fact: [one, two] }: Styles): number {
  return pen.width(fact.label, body) + pen.width(fact.value, value) + GAP_OF_FACT <= room ? one : two;
}

/** Paint a label and its value; return the height. */
function paintFact(pen: Pen, fact: Fact, top: number, width: number, style: Styles): number {
  const room = width - 2 * PAD;
  const value = { ...style.value, color: fact.tone === "plain" ? COLORS.text : TONES[fact.tone] };
  const height = heightOf(pen, fact, room, style);
  const middle = style.fact[0] / 2;
  pen.line(fact.label, PAD, top + middle, style.body, room);
  pen.lineTo(fact.value, width - PAD, top + height - middle, value);
  pen.box(PAD, top + height - 2, room, 2, COLORS.edge, 0);
  return height;
}

/** Return the items that fit, the focus among them. */
function aroundFocus(menu: Menu, most: number): readonly MenuItem[] {
  if (menu.items.length <= most) return menu.items;
  const focus = Math.max(0, menu.items.findIndex((item) => item.name === menu.focus));
  const first = Math.min(menu.items.length - most, Math.max(0, focus - Math.floor(most / 2)));
  return menu.items.slice(first, first + most);
}

/** Mark by a bar beside the items in sight that there are others. */
function paintMore(pen: Pen, menu: Menu, shown: readonly MenuItem[], middle: number, top: number): void {
  const count = menu.items.length;
  if (shown.length === count) return;
  const height = shown.length * (ROW + GAP) - GAP;
  const start = (height * menu.items.indexOf(shown[0]!)) / count;
  pen.box(middle - BAR / 2, top, BAR, height, COLORS.field, BAR / 2);
  pen.box(middle - BAR / 2, top + start, BAR, (height * shown.length) / count, COLORS.pale, BAR / 2);
}

function paintItem(
  pen: Pen,
  item: MenuItem,
  x: number,
  y: number,
  width: number,
  isFocus: boolean,
  isHovered: boolean,
): void {
  pen.box(x, y, width, ROW, isFocus && item.isEnabled ? COLORS.accent : COLORS.row);
  if (isFocus || isHovered) pen.frame(x, y, width, ROW, COLORS.accentEdge);
  const middle = y + ROW / 2 + 2;
  const label = item.isEnabled ? LABEL : PALE;
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
