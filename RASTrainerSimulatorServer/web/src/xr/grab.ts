/** Grab and move: while the grip is held, the tool's tip follows the hand. */

import { Vector3, type Object3D } from "three";

/** The tip's speed while the stick is fully pushed; a lag is made up in so long. */
const FULL_M_S = 0.15;
const CATCH_UP_S = 0.27;
/** Where pictures are rare the tip is slower, or it would swing about the hand. */
const CATCH_UP_PICTURES = 4;
const SMOOTHING = 0.2;
const REST_M = 0.001;
/** The simulator's sticks: dead zone, and exponent of their response. */
const DEAD_ZONE = 0.12;
const EXPONENT = 2;

export class Grab {
  isAllowed = true;
  private hand: Object3D | null = null;
  private readonly axes = [new Vector3(0, 0, 1), new Vector3(1, 0, 0), new Vector3(0, 1, 0)] as const;
  private readonly handBegan = new Vector3();
  private readonly tipBegan = new Vector3();
  private readonly lag = new Vector3();
  private readonly now = new Vector3();
  private tool: Object3D | undefined;
  /** Time between pictures, s. */
  private interval = 0;

  /** Know the tool's node. */
  take(tool: Object3D | undefined): void {
    this.tool = tool;
  }

  /** Know where forward of the sticks points, a level unit vector: by default along the robot's x. */
  turn(ahead: Vector3): void {
    const [right, forward, up] = this.axes;
    forward.copy(ahead);
    right.crossVectors(forward, up);
  }

  begin(hand: Object3D): void {
    if (!this.isAllowed || this.tool === undefined) return;
    this.hand = hand;
    hand.getWorldPosition(this.handBegan);
    this.tool.getWorldPosition(this.tipBegan);
  }

  /** Release, if it is this hand that holds. */
  end(hand: Object3D): void {
    if (hand === this.hand) this.hand = null;
  }

  /** Push the stick, `passed` s after the last time, so that the tip follows the grabbing hand. */
  steer(translation: number[], passed: number): void {
    this.interval += SMOOTHING * (passed - this.interval);
    if (this.hand === null || this.tool === undefined) return;
    this.hand.getWorldPosition(this.lag).sub(this.handBegan).add(this.tipBegan);
    this.lag.sub(this.tool.getWorldPosition(this.now));
    const size = this.lag.length();
    // So that the tip's speed is proportional to its lag, down to where it rests.
    const catchUp = Math.max(CATCH_UP_S, CATCH_UP_PICTURES * this.interval);
    const speed = Math.min(1, size / (FULL_M_S * catchUp));
    const push = size < REST_M ? 0 : (DEAD_ZONE + (1 - DEAD_ZONE) * speed ** (1 / EXPONENT)) / size;
    for (let index = 0; index < 3; index++) {
      translation[index] = push * this.lag.dot(this.axes[index]!);
    }
  }
}
