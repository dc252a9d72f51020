/** Paint what is read while the arm is driven: the instruction, short facts and the controls. */

import { BANNERS, type Screen } from "../generated";
import type { Region } from "./panel";
import { COLORS, type Pen } from "./pen";

const PAD = 40;
const INSTRUCTION = { size: 46, color: COLORS.text, isBold: true };
const FACT = { size: 36, color: COLORS.text };
const HINT = { size: 32, color: COLORS.soft };
const CAP = { size: 32, color: COLORS.text, isBold: true };
/** Of the paint on the skin. */
const SAMPLE = "#57b5e8";
const NOTICE = { size: 32, color: COLORS.text };

/** Paint from the top on; the panel is as high as what is on it. Return the hints that can be chosen. */
export function paintWork(
  pen: Pen,
  screen: Screen,
  holder: string,
  width: number,
  height: number,
  hovered: string,
): readonly Region[] {
  const room = width - 2 * PAD;
  let y = paintBanner(pen, screen, width);
  for (const notice of screen.warnings.slice(0, 2)) {
    const lines = pen.wrapped(notice.text, NOTICE, room - 40).length;
    pen.box(PAD, y, room, lines * 41 + 22, BANNERS[notice.tone], 16);
    pen.paragraph(notice.text, PAD + 20, y + 12, NOTICE, room - 40);
    y += lines * 41 + 34;
  }
  let x = PAD;
  for (const fact of screen.status) {
    const isWide = pen.width(fact, FACT) > 0.5 * room - 16;
    if (isWide && x > PAD) {
      x = PAD;
      y += 52;
    }
    pen.line(fact, x, y + 26, FACT, isWide ? room : 0.5 * room);
    const isRowFull = isWide || x > PAD;
    x = isRowFull ? PAD : PAD + 0.5 * room;
    if (isRowFull) y += 52;
  }
  y += x > PAD ? 72 : 20;
  if (screen.coverage !== "") {
    pen.box(PAD, y - 10, 36, 36, SAMPLE, 8);
    pen.line(screen.coverage, PAD + 52, y + 10, FACT, room - 52);
    y += 52;
  }
  const painted = paintHints(pen, screen, y, width, hovered);
  y = painted.bottom;
  pen.line(holder, PAD, y + 28, HINT, room);
  pen.behind(width, Math.min(height, y + 76), COLORS.night);
  return painted.hints;
}

function paintBanner(pen: Pen, screen: Screen, width: number): number {
  const { text, tone } = screen.instruction;
  const room = width - 2 * PAD;
  const lines = Math.max(1, pen.wrapped(text, INSTRUCTION, room - 48).length);
  const height = lines * 59 + 44;
  pen.box(PAD, PAD, room, height, BANNERS[tone]);
  pen.paragraph(text, PAD + 24, PAD + 22, INSTRUCTION, room - 48);
  return PAD + height + 24;
}

/** Return those that can be chosen, and where all of them end. */
function paintHints(
  pen: Pen,
  screen: Screen,
  top: number,
  width: number,
  hovered: string,
): { hints: readonly Region[]; bottom: number } {
  const hints: Region[] = [];
  let x = PAD;
  let y = top;
  for (const hint of screen.hints) {
    const cap = pen.width(hint.control, CAP) + 32;
    const total = cap + pen.width(hint.action, HINT) + 46;
    if (x + total > width - PAD && x > PAD) {
      x = PAD;
      y += 66;
    }
    const isHovered = hint.item !== "" && hint.item === hovered;
    pen.box(x, y, cap, 52, isHovered ? COLORS.accent : COLORS.row, 12);
    pen.frame(x, y, cap, 52, COLORS.edge, 12);
    pen.line(hint.control, x + 16, y + 28, CAP);
    pen.line(hint.action, x + cap + 14, y + 28, HINT);
    if (hint.item !== "") hints.push({ name: hint.item, x, y, width: total - 20, height: 52 });
    x += total;
  }
  return { hints, bottom: screen.hints.length > 0 ? y + 66 : y };
}
