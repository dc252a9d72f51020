/** A drawing of what the trainee has in their hands; the inputs that do something are colored. */

import { nameOf } from "../key_names";
import type { Menu } from "../generated";
import { say, type TextName } from "../texts";
import { COLORS } from "./pen";

/** Size of every drawing, in its own units. */
export const PICTURE_WIDTH = 1000;
export const PICTURE_HEIGHT = 520;

export type Kind = "gamepad" | "keyboard" | "controllers";

const BODY = "#33415a";
const RIM = "#8da0bd";
const FACES = { A: "#3ccb7f", B: "#ff5252", X: "#5aa2ff", Y: "#ffb92e" } as const;
const KEY = 64;
const GAP = 8;

/** Return the drawing of a device; `inputs` are those that do something, as named to people. */
export function controlsPicture(kind: Kind, inputs: readonly string[]): string {
  const sketch = new Sketch(inputs);
  DRAW[kind](sketch);
  return svgPicture(sketch.parts, PICTURE_HEIGHT);
}

/** Return a drawing of these parts as the address of a picture. */
export function svgPicture(parts: readonly string[], height: number): string {
  const size = `width="${PICTURE_WIDTH}" height="${height}" viewBox="0 0 ${PICTURE_WIDTH} ${height}"`;
  const font = 'font-family="system-ui, sans-serif" font-weight="700" text-anchor="middle"';
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" ${size} ${font}>${parts.join("")}</svg>`;
  return `data:image/svg+xml,${encodeURIComponent(svg)}`;
}

/** Return the inputs that a menu's table names, such as "W" of "W / A". */
export function inputsOf(menu: Menu): readonly string[] {
  return menu.facts.flatMap((fact) => fact.value.split(" / "));
}

const DRAW: Readonly<Record<Kind, (sketch: Sketch) => void>> = {
  gamepad: drawGamepad,
  keyboard: drawKeyboard,
  controllers: drawControllers,
};

class Sketch {
  readonly parts: string[] = [];

  constructor(private readonly inputs: readonly string[]) {}

  /** Tell whether an input, or one of those that begin with its name, does something. */
  isUsed(name: string): boolean {
    return this.inputs.some((input) => input === name || input.startsWith(`${name} `));
  }

  slab(x: number, y: number, width: number, height: number, radius: number, color: string, rim = "none"): void {
    const place = `x="${x}" y="${y}" width="${width}" height="${height}" rx="${radius}"`;
    this.parts.push(`<rect ${place} fill="${color}" stroke="${rim}" stroke-width="4"/>`);
  }

  disk(x: number, y: number, radius: number, color: string, rim: string): void {
    this.parts.push(`<circle cx="${x}" cy="${y}" r="${radius}" fill="${color}" stroke="${rim}" stroke-width="5"/>`);
  }

  shape(path: string, color: string): void {
    this.parts.push(`<path d="${path}" fill="${color}"/>`);
  }

  label(text: string, x: number, y: number, size: number, color: string = COLORS.text): void {
    const place = `x="${x}" y="${y}" dominant-baseline="central"`;
    this.parts.push(`<text ${place} font-size="${size}" fill="${color}">${text}</text>`);
  }

  /** A button or key with its name on it; `input` is its name in the texts. */
  button(text: string, input: string, x: number, y: number, width: number, height: number, isUsed = this.isUsed(input)): void {
    this.slab(x, y, width, height, 14, isUsed ? COLORS.accent : COLORS.row, isUsed ? COLORS.accentEdge : COLORS.edge);
    this.label(text, x + width / 2, y + height / 2, 34, isUsed ? COLORS.text : COLORS.pale);
  }

  face(name: keyof typeof FACES, x: number, y: number): void {
    const isUsed = this.isUsed(name);
    this.disk(x, y, 37, isUsed ? FACES[name] : COLORS.row, FACES[name]);
    this.label(name, x, y, 40, isUsed ? COLORS.night : FACES[name]);
  }

  stick(name: string, input: string, x: number, y: number): void {
    const isUsed = this.isUsed(input);
    this.disk(x, y, 74, COLORS.row, isUsed ? COLORS.accentEdge : RIM);
    this.disk(x, y, 50, isUsed ? COLORS.accent : BODY, isUsed ? COLORS.accentEdge : RIM);
    this.label(name, x, y, 40);
    for (const [across, down] of [[0, -1], [1, 0], [0, 1], [-1, 0]] as const) {
      const corner = (far: number, aside: number) =>
        `${x + far * across - aside * down} ${y + far * down + aside * across}`;
      this.shape(`M${corner(68, 0)} L${corner(57, 11)} L${corner(57, -11)} Z`, isUsed ? COLORS.accentEdge : RIM);
    }
  }
}

function drawGamepad(sketch: Sketch): void {
  for (const [name, x, y] of [["LT", 130, 4], ["LB", 130, 74], ["RT", 730, 4], ["RB", 730, 74]] as const) {
    sketch.button(name, name, x, y, 140, 60);
  }
  sketch.shape("M120 210 Q110 130 220 130 H780 Q890 130 880 210 L950 430 Q960 516 880 500 Q840 490 790 420 H210 Q160 490 120 500 Q40 516 50 430 Z", BODY);
  const isCrossUsed = sketch.isUsed(say("part.cross"));
  for (const [width, height] of [[150, 50], [50, 150]] as const) {
    sketch.slab(205 - width / 2, 235 - height / 2, width, height, 12, isCrossUsed ? COLORS.accent : COLORS.row);
  }
  sketch.stick("L", say("part.leftStick"), 370, 370);
  sketch.stick("R", say("part.rightStick"), 630, 370);
  sketch.face("Y", 795, 180);
  sketch.face("X", 725, 242);
  sketch.face("B", 865, 242);
  sketch.face("A", 795, 304);
  sketch.button("Back", say("part.back"), 350, 190, 110, 56);
  sketch.button("Start", say("part.start"), 540, 190, 110, 56);
}

function drawKeyboard(sketch: Sketch): void {
  const rows: readonly (readonly [number, readonly (readonly [string, string, number])[]])[] = [
    [0, [["Esc", "Esc", 1.4], ...letters("1234567890"), ["⌫", say("part.backspace"), 1.8]]],
    [0, [["↹", "Tab", 1.9], ...letters("QWERTYUIOP")]],
    [2.2, [...letters("ASDFGHJKL"), ["↵", say("part.enter"), 2]]],
    [0, [["⇧", say("part.leftShift"), 2.6], ...letters("ZXCVBNM"), ["⇧", say("part.rightShift"), 1.6]]],
    [2.6, [["", say("part.space"), 6]]],
  ];
  const step = KEY + GAP;
  const top = 60;
  rows.forEach(([begin, keys], row) => {
    let x = 20 + begin * step;
    for (const [text, input, width] of keys) {
      sketch.button(text, input, x, top + row * (step + 6), width * step - GAP, step);
      x += width * step;
    }
  });
  const bottom = top + 4 * (step + 6);
  for (const [text, across, up] of [["←", 0, 0], ["↓", 1, 0], ["→", 2, 0], ["↑", 1, 1]] as const) {
    sketch.button(text, text, 760 + across * step, bottom - up * (step + 6), KEY, step);
  }
}

function letters(text: string): (readonly [string, string, number])[] {
  return [...text].map((place) => [nameOf(place), nameOf(place), 1] as const);
}

function drawControllers(sketch: Sketch): void {
  for (const [x, stick, near, far] of [[250, "leftStick", "X", "Y"], [750, "rightStick", "A", "B"]] as const) {
    const inward = x < 500 ? 1 : -1;
    sketch.slab(x - 75, 170, 150, 340, 70, BODY);
    sketch.disk(x, 200, 150, BODY, RIM);
    sketch.button(say("part.trigger"), say("part.trigger"), x - 110, 4, 220, 60);
    // The grips are the page's own, so that no menu of the simulator names them: either moves the tip.
    sketch.button(say("part.grip"), say("part.grip"), x - inward * 75 - 90, 400, 180, 60, true);
    const name: TextName = `part.${stick}`;
    sketch.stick(x < 500 ? "L" : "R", say(name), x - inward * 60, 200);
    sketch.face(near, x + inward * 70, 250);
    sketch.face(far, x + inward * 80, 150);
  }
}
