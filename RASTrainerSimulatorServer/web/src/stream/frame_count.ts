/** How smoothly the picture is drawn, reported to the simulator once a second. */

import { MAX_FRAMES } from "../generated";
import type { Connection } from "./connection";

const PERIOD_MS = 1000;
const SMOOTHING = 0.1;

export class FrameCount {
  private shown = 0;
  private dropped = 0;
  private last = 0;
  private reported = 0;
  /** Interval of the display's pictures, ms; estimated unless `fixedHz` is known. */
  private interval = 1000 / 60;
  fixedHz = 0;

  constructor(private readonly connection: Connection) {}

  get refreshHz(): number {
    return this.fixedHz > 0 ? this.fixedHz : 1000 / this.interval;
  }

  /** The display asks for a picture at `now` (ms); pictures that it skipped were dropped. */
  asked(now: number): void {
    const passed = now - this.last;
    this.last = now;
    if (passed <= 0 || passed > PERIOD_MS) return;
    const period = 1000 / this.refreshHz;
    this.dropped += Math.max(0, Math.round(passed / period) - 1);
    // The shortest intervals are the display's own; longer intervals are late pictures.
    if (passed < 1.5 * this.interval) this.interval += SMOOTHING * (passed - this.interval);
    else this.interval += 0.002 * (passed - this.interval);
  }

  /** A picture was drawn. */
  drawn(): void {
    this.shown++;
  }

  /** Report the counts if it is time. */
  tell(now: number): void {
    if (now - this.reported < PERIOD_MS) return;
    this.reported = now;
    this.connection.send({
      type: "frames",
      shown: Math.min(MAX_FRAMES, this.shown),
      dropped: Math.min(MAX_FRAMES, this.dropped),
      refreshHz: Math.min(1000, Math.round(10 * this.refreshHz) / 10),
    });
    this.shown = this.dropped = 0;
  }

  /** Start over, on another display. */
  reset(fixedHz = 0): void {
    this.fixedHz = fixedHz;
    this.shown = this.dropped = 0;
    this.last = this.reported = performance.now();
  }
}
