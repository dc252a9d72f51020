/** The bull's-eye or the depth ruler at the edge of a flat picture. */

import { byId } from "../elements";
import type { GuideAim, DepthRuler } from "../generated";
import { GUIDING_HEIGHT, GUIDING_WIDTH, guidingContent, paintGuiding } from "../panels/guiding_painter";
import { Pen } from "../panels/pen";

export class GuidingPanel {
  private readonly canvas = byId("guiding") as HTMLCanvasElement;
  private readonly context: CanvasRenderingContext2D;
  private shown = "";

  constructor() {
    this.canvas.width = GUIDING_WIDTH;
    this.canvas.height = GUIDING_HEIGHT;
    this.context = this.canvas.getContext("2d")!;
  }

  /** Show how the line lies to the guide, or a depth (mm); neither hides the panel. */
  show(aim: GuideAim | null, ruler: DepthRuler | null, depth: number): void {
    const content = guidingContent(aim, ruler, depth);
    if (content === this.shown) return;
    this.shown = content;
    this.canvas.hidden = content === "";
    this.context.clearRect(0, 0, GUIDING_WIDTH, GUIDING_HEIGHT);
    if (content !== "") paintGuiding(new Pen(this.context), aim, ruler, depth);
  }
}
