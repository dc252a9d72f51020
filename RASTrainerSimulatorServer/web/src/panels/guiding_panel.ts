/** The bull's-eye along the guide's axis, or the depth ruler, on a canvas: flat, or in the room. */

import {
  BULLS_EYE_FARTHEST_MM, BULLS_EYE_NEAR_MM, BULLS_EYE_RADIUS, BULLS_EYE_RINGS_MM, ENTRY_DOT, ON_LINE_DEG, ON_LINE_MM,
  RULER_BEYOND_MM, RULER_TICK_MM, TARGET_RING, TONES, type GuideAim, type DepthRuler,
} from "../generated";
import { figure } from "../texts";
import { COLORS, Pen } from "./pen";

const WIDTH = 360;
const HEIGHT = 440;
const PAD = 24;
const GOOD = TONES.good;
const OFF = TONES.warning;
const FIGURE = { size: 40, color: COLORS.text, isBold: true };
/** So that three digits of millimeters leave a gap before the angle. */
const PAIR = { ...FIGURE, size: 34 };
const SMALL = { size: 26, color: COLORS.soft };

const TRACK = { left: 74, width: 36, top: 84, bottom: 416 };

export class GuidingPanel {
  private readonly context: CanvasRenderingContext2D;
  private shown = "";

  constructor(readonly canvas: HTMLCanvasElement) {
    canvas.width = WIDTH;
    canvas.height = HEIGHT;
    this.context = canvas.getContext("2d")!;
  }

  /** Show how the line lies to the guide, or a depth (mm); neither hides the panel. Return whether anything has changed. */
  show(aim: GuideAim | null, ruler: DepthRuler | null, depth: number): boolean {
    const content = contentOf(aim, ruler, depth);
    if (content === this.shown) return false;
    this.shown = content;
    this.canvas.hidden = content === "";
    this.context.clearRect(0, 0, WIDTH, HEIGHT);
    if (content === "") return true;
    const pen = new Pen(this.context);
    pen.box(0, 0, WIDTH, HEIGHT, "rgba(14, 23, 38, 0.84)");
    if (ruler !== null) paintRuler(pen, ruler, depth);
    else if (aim !== null) paintAim(pen, aim);
    return true;
  }
}

/** Return a text that changes with all that is painted. */
function contentOf(aim: GuideAim | null, ruler: DepthRuler | null, depth: number): string {
  if (ruler !== null) return JSON.stringify([ruler, depth.toFixed(1)]);
  if (aim === null) return "";
  const places = [...aim.entryMm, ...aim.targetMm, aim.entryDistanceMm, aim.angleDeg];
  return places.map((value) => value.toFixed(1)).join(" ");
}

function paintAim(pen: Pen, aim: GuideAim): void {
  const middle = WIDTH / 2;
  for (const ring of [...BULLS_EYE_RINGS_MM, BULLS_EYE_FARTHEST_MM]) pen.circle(middle, middle, BULLS_EYE_RADIUS * shownRadius(ring), COLORS.pale, 3);
  pen.stroke(middle - BULLS_EYE_RADIUS, middle, middle + BULLS_EYE_RADIUS, middle, COLORS.pale, 2);
  pen.stroke(middle, middle - BULLS_EYE_RADIUS, middle, middle + BULLS_EYE_RADIUS, COLORS.pale, 2);
  const isGood = aim.entryDistanceMm <= ON_LINE_MM && aim.angleDeg <= ON_LINE_DEG;
  const color = isGood ? GOOD : OFF;
  const [entryX, entryY] = shown(aim.entryMm, middle);
  const [targetX, targetY] = shown(aim.targetMm, middle);
  pen.stroke(entryX, entryY, targetX, targetY, color, 4);
  pen.circle(targetX, targetY, TARGET_RING, color, 5);
  pen.circle(entryX, entryY, ENTRY_DOT, color);
  const y = WIDTH + 36;
  pen.line(`${figure(aim.entryDistanceMm)} mm`, PAD, y, PAIR);
  pen.lineTo(`${figure(aim.angleDeg)}°`, WIDTH - PAD, y, PAIR);
}

/** Return the drawn radius of a distance, as a share of the whole; small distances are spread. */
function shownRadius(distance: number): number {
  return Math.min(1, Math.log1p(distance / BULLS_EYE_NEAR_MM) / Math.log1p(BULLS_EYE_FARTHEST_MM / BULLS_EYE_NEAR_MM));
}

function shown([right, up]: readonly [number, number], middle: number): [number, number] {
  const distance = Math.hypot(right, up);
  if (distance === 0) return [middle, middle];
  const far = (BULLS_EYE_RADIUS * shownRadius(distance)) / distance;
  return [middle + far * right, middle - far * up];
}

function paintRuler(pen: Pen, ruler: DepthRuler, depth: number): void {
  const { left, width, top, bottom } = TRACK;
  const longest = Math.max(ruler.targetMm, depth, 1) + RULER_BEYOND_MM;
  const y = (mm: number) => top + ((bottom - top) * Math.max(mm, 0)) / longest;
  pen.line(`${figure(depth)} mm`, PAD, 44, FIGURE);
  pen.box(left, top, width, bottom - top, COLORS.field, 4);
  if (ruler.outerMm !== null && ruler.innerMm !== null) {
    pen.box(left, y(ruler.outerMm), width, y(ruler.innerMm) - y(ruler.outerMm), COLORS.pale, 0);
  }
  pen.box(left + width / 3, top, width / 3, y(depth) - top, COLORS.accent, 0);
  for (let tick = 0; tick < longest; tick += RULER_TICK_MM) {
    pen.stroke(left - 14, y(tick), left, y(tick), COLORS.pale, 2);
    if (tick % (2 * RULER_TICK_MM) === 0) pen.lineTo(String(tick), left - 22, y(tick), SMALL);
  }
  let lowest = -Infinity;
  const marks = [
    [ruler.entryMm, GOOD],
    [ruler.outerMm, OFF],
    [ruler.innerMm, OFF],
    [ruler.targetMm, GOOD],
  ] as const;
  const begin = left + width + 26;
  for (const [index, [mm, color]] of marks.entries()) {
    if (mm === null) continue;
    pen.stroke(left - 4, y(mm), left + width + 20, y(mm), color, 4);
    // Outer and inner table are near each other: their figures must not cover each other.
    lowest = Math.max(y(mm), lowest + 30);
    pen.line(`${mm.toFixed(0)} ${ruler.names[index]}`, begin, lowest, { size: 22, color }, WIDTH - begin - 8);
  }
}
