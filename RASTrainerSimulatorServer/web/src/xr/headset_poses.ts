/** Tells spectators, by way of the simulator, where the headset and its controllers are. */

import { Matrix4, Quaternion, Vector3, type Object3D } from "three";

import type { Connection } from "../stream/connection";
import type { Pose } from "../generated";

const PERIOD_S = 1 / 30;
const DIGITS = 5;

export class HeadsetPoses {
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

  /** Send the poses at `now` (s) if it is time; a hand that is not there is null. */
  send(now: number, eyes: Object3D, left: Object3D | null, right: Object3D | null): void {
    if (now - this.sentAt < PERIOD_S) return;
    this.sentAt = now;
    this.toWorld.copy(this.world.matrixWorld).invert();
    this.connection.send({
      type: "headsetPose",
      eyes: this.pose(eyes),
      left: left && this.pose(left),
      right: right && this.pose(right),
    });
  }

  /** Send that nobody wears the headset. */
  sendDoffed(): void {
    this.connection.send({ type: "headsetPose", eyes: null, left: null, right: null });
  }

  private pose(object: Object3D): Pose {
    this.matrix.multiplyMatrices(this.toWorld, object.matrixWorld).decompose(this.place, this.turn, this.size);
    return [...this.place.toArray(), ...this.turn.toArray()].map((value) => Number(value.toFixed(DIGITS))) as unknown as Pose;
  }
}
