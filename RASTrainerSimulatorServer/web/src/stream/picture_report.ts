/** How much of a task's scene is loaded and drawn: the simulator has the task wait for it. */

import type { Connection } from "./connection";

const STEP = 0.05;

export class PictureReport {
  private task: string | null = null;
  private share = 0;

  constructor(private readonly connection: Connection) {}

  /** Nothing is drawn yet, as far as the simulator knows. */
  begin(): void {
    this.tell("", 0);
    this.task = null;
  }

  /** So many bytes of a task's scene have come, of `total`, which is 0 if unknown. */
  loaded(task: string, bytes: number, total: number): void {
    const share = total > 0 ? Math.min(1 - STEP, bytes / total) : 0;
    if (task !== this.task || share >= this.share + STEP) this.tell(task, share);
  }

  /** A picture of a task's scene was drawn. */
  drawn(task: string): void {
    if (task !== this.task || this.share < 1) this.tell(task, 1);
  }

  private tell(task: string, share: number): void {
    this.task = task;
    this.share = share;
    this.connection.send({ type: "picture", task, share });
  }
}
