/** A trainee's scores as bars, with the pass mark as a line: a drawing as in controls_picture. */

import { TARGET_COLOR, TONES, type ScoreTrend } from "../generated";
import { PICTURE_WIDTH, svgPicture } from "./controls_picture";
import { COLORS } from "./pen";

const HEIGHT = 580;
const TOP = 60;
const BOTTOM = 560;
const BROADEST_BAR = 110;

/** Return the drawing as the address of a picture. */
export function trendPlot(trend: ScoreTrend): string {
  const count = trend.scores.length;
  const step = Math.min(PICTURE_WIDTH / count, BROADEST_BAR);
  const bars = trend.scores.map((score, number) => {
    const top = level(Math.min(100, Math.max(0.5, score)));
    const color = trend.mark > 0 && score >= trend.mark ? TONES.good : TONES.plain;
    return rect(number * step, top, 0.72 * step, BOTTOM - top, color);
  });
  const last = trend.scores[count - 1] ?? 0;
  const middle = (count - 1) * step + 0.36 * step;
  const number = `<text x="${Math.max(30, middle)}" y="${level(last) - 12}" font-size="36" fill="${COLORS.text}">${last.toFixed(0)}</text>`;
  const mark = trend.mark > 0 ? rect(0, level(trend.mark) - 2, PICTURE_WIDTH, 4, TARGET_COLOR) : "";
  const floor = rect(0, BOTTOM, PICTURE_WIDTH, 4, COLORS.pale);
  return svgPicture([...bars, floor, mark, number], HEIGHT);
}

function level(score: number): number {
  return BOTTOM - ((BOTTOM - TOP) * score) / 100;
}

function rect(x: number, y: number, width: number, height: number, color: string): string {
  return `<rect x="${x}" y="${y}" width="${width}" height="${height}" fill="${color}"/>`;
}
