/** Tells spectators, by way of the simulator, where the headset and its controllers are. */

import { Matrix4, Quaternion, Vector3, type Object3D } from "three";

import type { Connection } from "../stream/connection";
import type { Pose } from "../stream/messages";

const PERIOD_S = 1 / 30;
const DIGITS = 5;

export class WornPoses {
  private sentAt = -Infinity;
  private readonly toWorld = new Matrix4();
  private readonly matrix = new Matrix4();
  private readonly place = new Vector3();
  private readonly turn = new Quaternion();
  private readonly size = new Vector3();

  constructor(
    private readonly connection: Connection,
    /** The object whose frame is World. */
    private readonly world: Object3D,
  ) {}

  /** Tell the poses at `now` (s) if it is time; a hand that is not there is null. */
  tell(now: number, eyes: Object3D, left: Object3D | null, right: Object3D | null): void {
    if (now - this.sentAt < PERIOD_S) return;
    this.sentAt = now;
    this.toWorld.copy(this.world.matrixWorld).invert();
    this.connection.send("worn", {
      eyes: this.pose(eyes),
      left: left && this.pose(left),
      right: right && this.pose(right),
    });
  }

  /** Tell that nobody wears the headset. */
  takeOff(): void {
    this.connection.send("worn", { eyes: null, left: null, right: null });
  }

  private pose(object: Object3D): Pose {
    this.matrix.multiplyMatrices(this.toWorld, object.matrixWorld).decompose(this.place, this.turn, this.size);
    return [...this.place.toArray(), ...this.turn.toArray()].map((value) => Number(value.toFixed(DIGITS))) as unknown as Pose;
  }
}
