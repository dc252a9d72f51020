/** Where the trainee stands or sits in the room, and how high the table is for them. */

import { Euler, Group, Quaternion, Vector3 } from "three";

import type { CameraPose } from "../generated";
import { yUp } from "../scene/viewpoint";

/** Distance from the head to the trainee's eyes: a comfortable reach, seated and standing. */
const AWAY_M = 0.62;
const EYES_ABOVE_M = 0.45;
const STEP_M = 0.03;
const MAX_RISE_M = 0.45;
const STORED = "rastrainer-table";

export class Placement {
  /** The headset's space, the parent of tracked objects. */
  readonly rig = new Group();
  /** Where the eyes come to, in three's frame. */
  readonly eyes = new Vector3();
  /** Horizontal, toward the head. */
  readonly forward = new Vector3(0, 0, -1);
  private rise = Number(localStorage.getItem(STORED)) || 0;
  /** The point of interest: the middle of the patient's head. */
  readonly focus = new Vector3();
  private readonly seen = new Vector3();
  private seenYaw = 0;

  /** Stand behind the close-up camera, looking where it looks. */
  take(camera: CameraPose): void {
    const position = yUp(new Vector3().fromArray(camera.position));
    yUp(this.focus.fromArray(camera.focalPoint));
    this.forward.subVectors(this.focus, position).setY(0).normalize();
    this.settle();
  }

  /** Raise the table by a number of steps. */
  raise(steps: number): void {
    this.rise = Math.min(MAX_RISE_M, Math.max(-MAX_RISE_M, this.rise + steps * STEP_M));
    localStorage.setItem(STORED, String(this.rise));
    this.settle();
  }

  /** Have the eyes, which the headset sees in such a pose, come to where they belong. */
  recenter(pose: XRViewerPose): void {
    const { position, orientation } = pose.transform;
    this.seen.set(position.x, position.y, position.z);
    turn.set(orientation.x, orientation.y, orientation.z, orientation.w);
    this.seenYaw = euler.setFromQuaternion(turn, "YXZ").y;
    this.settle();
  }

  private settle(): void {
    this.eyes.copy(this.focus).addScaledVector(this.forward, -AWAY_M);
    this.eyes.y += EYES_ABOVE_M - this.rise;
    const yaw = Math.atan2(-this.forward.x, -this.forward.z) - this.seenYaw;
    this.rig.quaternion.setFromEuler(euler.set(0, yaw, 0, "YXZ"));
    this.rig.position.copy(this.seen).applyQuaternion(this.rig.quaternion).negate().add(this.eyes);
  }
}

const turn = new Quaternion();
const euler = new Euler();
