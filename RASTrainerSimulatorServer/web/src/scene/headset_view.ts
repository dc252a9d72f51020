/** A headset as a spectator sees it: its eyes' place for the camera, and its controllers in the room. */

import { CapsuleGeometry, Group, Mesh, MeshLambertMaterial, Object3D, Vector3 } from "three";

import type { CameraPose, Pose, HeadsetPose } from "../generated";
import { PoseStream } from "./pose_stream";

/** Vertical field of view, wide enough to see the wearer's hands. */
const ANGLE_DEG = 70;
const AT_REST: Pose = [0, 0, 0, 0, 0, 0, 1];
const BODIES = 3;

export class HeadsetView {
  private readonly eyes = new Object3D();
  private readonly hands = [controllerBody(), controllerBody()] as const;
  private stream = new PoseStream(BODIES);
  private isWorn = false;
  private readonly ahead = new Vector3();
  private readonly up = new Vector3();

  /** `world` is the object whose frame is World. */
  constructor(world: Object3D) {
    world.add(...this.hands);
    for (const hand of this.hands) hand.visible = false;
  }

  /** Take what arrived at `now` (s); null while nobody wears a headset. */
  put(pose: HeadsetPose | null, now: number): void {
    const [left, right] = this.hands;
    left.visible = pose?.left != null;
    right.visible = pose?.right != null;
    const eyes = pose?.eyes ?? null;
    // The wearer is elsewhere when it is put on again.
    if (eyes === null && this.isWorn) this.stream = new PoseStream(BODIES);
    this.isWorn = eyes !== null;
    if (eyes !== null) this.stream.put(now, [eyes, pose?.left ?? AT_REST, pose?.right ?? AT_REST], now);
  }

  /** Return where the eyes look from at `now` (s), and place the hands; null while nobody wears a headset. */
  place(now: number): CameraPose | null {
    if (!this.isWorn) return null;
    this.stream.place([this.eyes, ...this.hands], now);
    const { position, quaternion } = this.eyes;
    return {
      position: position.toArray(),
      focalPoint: this.ahead.set(0, 0, -1).applyQuaternion(quaternion).add(position).toArray(),
      viewUp: this.up.set(0, 1, 0).applyQuaternion(quaternion).toArray(),
      viewAngleDeg: ANGLE_DEG,
    };
  }
}

/** Return a controller's body: a dark capsule behind the origin of its ray, along −z. */
export function controllerBody(): Group {
  const body = new Mesh(new CapsuleGeometry(0.018, 0.09, 4, 10).rotateX(Math.PI / 2), new MeshLambertMaterial({ color: 0x2a3444 }));
  body.position.z = 0.05;
  return new Group().add(body);
}
