/** The bull's-eye or the depth ruler on a canvas, at the edge of a flat picture or in the room. */

import type { GuideAim, DepthRuler } from "../generated";
import { GUIDING_HEIGHT, GUIDING_WIDTH, guidingContent, paintGuiding } from "../panels/guiding_painter";
import { Pen } from "../panels/pen";

export class GuidingPanel {
  private readonly context: CanvasRenderingContext2D;
  private shown = "";

  constructor(readonly canvas: HTMLCanvasElement) {
    canvas.width = GUIDING_WIDTH;
    canvas.height = GUIDING_HEIGHT;
    this.context = canvas.getContext("2d")!;
  }

  /** Show how the line lies to the guide, or a depth (mm); neither hides the panel. Return whether anything has changed. */
  show(aim: GuideAim | null, ruler: DepthRuler | null, depth: number): boolean {
    const content = guidingContent(aim, ruler, depth);
    if (content === this.shown) return false;
    this.shown = content;
    this.canvas.hidden = content === "";
    this.context.clearRect(0, 0, GUIDING_WIDTH, GUIDING_HEIGHT);
    if (content !== "") paintGuiding(new Pen(this.context), aim, ruler, depth);
    return true;
  }
}
