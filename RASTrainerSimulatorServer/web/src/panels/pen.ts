/** Text and boxes on a canvas, in its pixels, with the colors of the flat page. */

import { NIGHT, TEXT } from "../generated";
import { pieces } from "./line_breaks";

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
export const LINE = 1.28;

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

  /** Fill behind all that is painted already. */
  behind(width: number, height: number, color: string, radius = 40): void {
    this.context.globalCompositeOperation = "destination-over";
    this.box(0, 0, width, height, color, radius);
    this.context.globalCompositeOperation = "source-over";
  }

  frame(x: number, y: number, width: number, height: number, color: string, radius = 20): void {
    this.context.strokeStyle = color;
    this.context.lineWidth = 4;
    this.context.beginPath();
    this.context.roundRect(x + 2, y + 2, width - 4, height - 4, radius);
    this.context.stroke();
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

  /** Paint a picture in the middle of a box, as large as fits. */
  picture(image: HTMLImageElement, x: number, y: number, width: number, height: number): void {
    const factor = Math.min(width / image.naturalWidth, height / image.naturalHeight);
    const across = factor * image.naturalWidth;
    const down = factor * image.naturalHeight;
    this.context.drawImage(image, x + (width - across) / 2, y + (height - down) / 2, across, down);
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

  /** Return a text's lines, each within a width; a piece that is wider is broken within. */
  wrapped(text: string, style: TextStyle, room: number): string[] {
    this.use(style);
    const fits = (line: string) => this.context.measureText(line).width <= room;
    const lines: string[] = [];
    let line = "";
    for (const piece of pieces(text)) {
      const longer = line === "" ? piece.text : line + piece.between + piece.text;
      if (fits(longer)) {
        line = longer;
        continue;
      }
      if (line !== "") lines.push(line);
      line = "";
      for (const letter of piece.text) {
        if (line !== "" && !fits(line + letter)) {
          lines.push(line);
          line = "";
        }
        line += letter;
      }
    }
    return [...lines, line];
  }

  /** Write a text in as many lines as it needs; return the height that they take. */
  paragraph(text: string, x: number, y: number, style: TextStyle, room: number): number {
    const lines = this.wrapped(text, style, room);
    const step = LINE * style.size;
    lines.forEach((line, index) => this.line(line, x, y + (index + 0.5) * step, style));
    return lines.length * step;
  }

  image(image: HTMLImageElement, x: number, y: number): void {
    this.context.drawImage(image, x, y);
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
