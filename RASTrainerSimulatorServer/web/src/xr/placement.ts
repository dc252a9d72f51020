/** Where the trainee stands or sits in the room, and how high the table is for them. */

import { Euler, Quaternion, Vector3 } from "three";

import type { CameraPlace } from "../messages";
import { yUp } from "../viewpoint";

/** From the head to the trainee's eyes: a comfortable reach, seated and standing. */
const AWAY_M = 0.62;
const EYES_ABOVE_M = 0.45;
const STEP_M = 0.03;
const MOST_M = 0.45;
const STORED = "rastrainer-table";

export class Placement {
  /** Where the eyes come to, in three's frame. */
  readonly eyes = new Vector3();
  /** Horizontal, toward the head. */
  readonly forward = new Vector3(0, 0, -1);
  private rise = Number(localStorage.getItem(STORED)) || 0;
  private readonly focus = new Vector3();
  private readonly seen = new Vector3();
  private seenYaw = 0;
  private isSeen = false;

  /** Stand behind the close-up camera, looking where it looks. */
  take(camera: CameraPlace): void {
    const position = yUp(new Vector3().fromArray(camera.position));
    yUp(this.focus.fromArray(camera.focalPoint));
    this.forward.subVectors(this.focus, position).setY(0).normalize();
    this.settle();
  }

  /** Raise the table by so many steps. */
  raise(steps: number): void {
    this.rise = Math.min(MOST_M, Math.max(-MOST_M, this.rise + steps * STEP_M));
    localStorage.setItem(STORED, String(this.rise));
    this.settle();
  }

  /** Call where the eyes are now, in the headset's own space, the place to stand. */
  recenter(pose: XRViewerPose): void {
    const { position, orientation } = pose.transform;
    this.seen.set(position.x, position.y, position.z);
    turn.set(orientation.x, orientation.y, orientation.z, orientation.w);
    this.seenYaw = euler.setFromQuaternion(turn, "YXZ").y;
    this.isSeen = true;
  }

  /** Return the space in which the eyes are where they belong; null before the first look. */
  space(base: XRReferenceSpace): XRReferenceSpace | null {
    if (!this.isSeen) return null;
    const yaw = this.seenYaw - Math.atan2(-this.forward.x, -this.forward.z);
    turn.setFromEuler(euler.set(0, yaw, 0, "YXZ"));
    const origin = point.copy(this.eyes).applyQuaternion(turn).negate().add(this.seen);
    const { x, y, z, w } = turn;
    const place = { x: origin.x, y: origin.y, z: origin.z };
    return base.getOffsetReferenceSpace(new XRRigidTransform(place, { x, y, z, w }));
  }

  private settle(): void {
    this.eyes.copy(this.focus).addScaledVector(this.forward, -AWAY_M);
    this.eyes.y += EYES_ABOVE_M - this.rise;
  }
}

const turn = new Quaternion();
const euler = new Euler();
const point = new Vector3();
