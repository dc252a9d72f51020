/** Slices of the images with the registered points, and the plot that belongs to a menu: drawings as in controls_picture. */

import { TARGET_COLOR, TONES, type HeadSlices, type Menu, type Slice, type SliceLegend, type SliceLine, type SliceMark } from "../generated";
import { PICTURE_WIDTH, svgPicture } from "./controls_picture";
import { COLORS } from "./pen";
import { trendPlot } from "./trend_plot";

/** Two cells side by side, two below one another; the last one has the legend. */
const CELL = PICTURE_WIDTH / 2;
const MARGIN = 44;
const LETTER = 34;
const LEGEND_LINE = 34;
const LEGEND_LETTERS = 24;
/** A mark has its own shape besides its color. */
const LINES: Readonly<Partial<Record<SliceMark, string>>> = {
  skin: `stroke="${COLORS.soft}" stroke-width="4"`,
  residual: `stroke="${TARGET_COLOR}" stroke-width="6"`,
};
const SHAPES: Readonly<Partial<Record<SliceMark, string>>> = {
  point: `<circle r="9" fill="${COLORS.night}" stroke="${TONES.plain}" stroke-width="5"/>`,
  trace: `<circle r="3" fill="${COLORS.pale}"/>`,
  target: `<path d="M-20 0H20M0 -20V20" stroke="${TONES.good}" stroke-width="5"/><circle r="12" fill="none" stroke="${TONES.good}" stroke-width="5"/>`,
  reached: `<path d="M-15 -15L15 15M-15 15L15 -15" stroke="${TONES.error}" stroke-width="8"/>`,
  tip: `<path d="M-24 0H24M0 -24V24" stroke="${COLORS.text}" stroke-width="6"/>`,
};

/** Return the address of the plot of a menu, "" for none. */
export function plotOf(menu: Menu): string {
  if (menu.trend) return trendPlot(menu.trend);
  return menu.slices ? slicesPlot(menu.slices) : "";
}

function slicesPlot({ slices, legend }: HeadSlices): string {
  const reach = Math.max(...slices.flatMap(({ lines }) => lines.filter(isSkin).flatMap((line) => line.points.flat()).map(Math.abs)), 1);
  const scale = (CELL / 2 - MARGIN) / reach;
  const cells = slices.map((slice, number) => cell(slice, CELL * (number % 2), CELL * Math.floor(number / 2), scale));
  return svgPicture([...cells, legendOf(legend)], 2 * CELL);
}

function isSkin({ mark }: SliceLine): boolean {
  return mark === "skin";
}

/** A nested SVG picture clips at the edges of the cell. */
function cell({ name, letters, lines }: Slice, x: number, y: number, scale: number): string {
  const half = CELL / 2;
  const edge = half - LETTER / 2;
  const places = [[-edge, 12], [edge, 12], [0, edge + 8], [0, 28 - edge]] as const;
  const sides = places.map(([right, down], number) => words(letters[number] ?? "", right, down, LETTER, COLORS.text));
  const frame = `<rect x="${-half}" y="${-half}" width="${CELL - 8}" height="${CELL - 8}" rx="16" fill="${COLORS.field}"/>`;
  const title = words(name, 20 - half, 36 - half, 28, COLORS.pale, "start");
  const content = [frame, ...lines.map((line) => drawn(line, scale)), ...sides, title].join("");
  return `<svg x="${x}" y="${y}" width="${CELL}" height="${CELL}" viewBox="${-half} ${-half} ${CELL} ${CELL}">${content}</svg>`;
}

function drawn({ mark, points }: SliceLine, scale: number): string {
  const places = points.map(([right, up]) => `${(scale * right).toFixed(1)} ${(-scale * up).toFixed(1)}`);
  const style = LINES[mark];
  if (style) return `<polyline points="${places.join(" ")}" fill="none" stroke-linejoin="round" ${style}/>`;
  return places.map((place) => `<g transform="translate(${place})">${SHAPES[mark]}</g>`).join("");
}

function legendOf(legend: readonly SliceLegend[]): string {
  let down = CELL + 1.5 * LEGEND_LINE;
  const lines: string[] = [];
  for (const { mark, name } of legend) {
    const sample = SHAPES[mark] ?? `<path d="M-22 0H22" ${LINES[mark]}/>`;
    lines.push(`<g transform="translate(${CELL + 44} ${down - 10})">${sample}</g>`);
    for (const part of wrapped(name)) {
      lines.push(words(part, CELL + 88, down, 28, COLORS.text, "start"));
      down += LEGEND_LINE;
    }
    down += LEGEND_LINE / 2;
  }
  return lines.join("");
}

function wrapped(text: string): string[] {
  const lines: string[] = [];
  for (const word of text.split(" ")) {
    const longer = `${lines.at(-1) ?? ""} ${word}`.trim();
    if (lines.length > 0 && longer.length <= LEGEND_LETTERS) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

function words(text: string, x: number, y: number, size: number, color: string, anchor = "middle"): string {
  const escaped = text.replace(/[&<]/g, (sign) => `&#${sign.charCodeAt(0)};`);
  return `<text x="${x}" y="${y}" font-size="${size}" fill="${color}" text-anchor="${anchor}">${escaped}</text>`;
}
