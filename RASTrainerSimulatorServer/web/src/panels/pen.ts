/** Text and boxes on a canvas, in its pixels, with the colors of the flat page. */

import { NIGHT, TEXT } from "../generated";

export const COLORS = {
  night: NIGHT,
  row: "#1f2837",
  accent: "#1b6ad6",
  accentEdge: "#bfdbff",
  field: "#0a111d",
  edge: "#37445a",
  text: TEXT,
  soft: "#c3cede",
  pale: "#97a5bc",
};

const FAMILY = 'system-ui, "Segoe UI", Roboto, "Noto Sans", "PingFang SC", "Microsoft YaHei", "Noto Sans CJK SC", sans-serif';

export interface TextStyle {
  readonly size: number;
  readonly color: string;
  readonly isBold?: boolean;
}

export class Pen {
  constructor(private readonly context: CanvasRenderingContext2D) {
    context.textBaseline = "middle";
  }

  box(x: number, y: number, width: number, height: number, color: string, radius = 20): void {
    this.context.fillStyle = color;
    this.context.beginPath();
    this.context.roundRect(x, y, width, height, radius);
    this.context.fill();
  }

  /** Draw a circle, or fill it where no line width is given. */
  circle(x: number, y: number, radius: number, color: string, lineWidth = 0): void {
    this.context.beginPath();
    this.context.arc(x, y, radius, 0, 2 * Math.PI);
    this.context.strokeStyle = this.context.fillStyle = color;
    this.context.lineWidth = lineWidth;
    if (lineWidth > 0) this.context.stroke();
    else this.context.fill();
  }

  stroke(x: number, y: number, toX: number, toY: number, color: string, lineWidth: number): void {
    this.context.strokeStyle = color;
    this.context.lineWidth = lineWidth;
    this.context.beginPath();
    this.context.moveTo(x, y);
    this.context.lineTo(toX, toY);
    this.context.stroke();
  }

  width(text: string, style: TextStyle): number {
    this.use(style);
    return this.context.measureText(text).width;
  }

  /** Write one line, its middle at `y`; the text is cut where it is wider than `room`. */
  line(text: string, x: number, y: number, style: TextStyle, room = Infinity): void {
    this.use(style);
    this.context.fillText(this.cut(text, room), x, y);
  }

  /** Write one line that ends at `right`. */
  lineTo(text: string, right: number, y: number, style: TextStyle): void {
    this.line(text, right - this.width(text, style), y, style);
  }

  private use(style: TextStyle): void {
    this.context.font = `${style.isBold ? "700 " : ""}${style.size}px ${FAMILY}`;
    this.context.fillStyle = style.color;
  }

  private cut(text: string, room: number): string {
    if (this.context.measureText(text).width <= room) return text;
    let end = text.length;
    while (end > 1 && this.context.measureText(`${text.slice(0, end)}…`).width > room) end--;
    return `${text.slice(0, end)}…`;
  }
}
