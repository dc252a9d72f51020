/** Where a camera of the simulator stands, and how the picture flies from one to the other. */

import { type PerspectiveCamera, Vector3 } from "three";

import { FLIGHT_S, type CameraPose } from "../generated";

export class Viewpoint {
  readonly position = new Vector3();
  readonly focus = new Vector3();
  readonly up = new Vector3(0, 1, 0);
  angle = 30;

  /** Take the place of one of the simulator's cameras, which is in World, into three's y-up. */
  take(place: CameraPose): this {
    yUp(this.position.fromArray(place.position));
    yUp(this.focus.fromArray(place.focalPoint));
    yUp(this.up.fromArray(place.viewUp));
    this.angle = place.viewAngleDeg;
    return this;
  }

  copy(other: Viewpoint): this {
    this.position.copy(other.position);
    this.focus.copy(other.focus);
    this.up.copy(other.up);
    this.angle = other.angle;
    return this;
  }

  /** Stand between two others. */
  between(from: Viewpoint, to: Viewpoint, share: number): void {
    this.position.lerpVectors(from.position, to.position, share);
    this.focus.lerpVectors(from.focus, to.focus, share);
    this.up.lerpVectors(from.up, to.up, share);
    this.angle = from.angle + share * (to.angle - from.angle);
  }

  /** Set a camera here, at once also for projections before the next picture. */
  look(camera: PerspectiveCamera, aspect: number): void {
    camera.up.copy(this.up);
    camera.position.copy(this.position);
    camera.lookAt(this.focus);
    camera.updateMatrixWorld();
    if (camera.fov !== this.angle || camera.aspect !== aspect) {
      camera.fov = this.angle;
      camera.aspect = aspect;
      camera.updateProjectionMatrix();
    }
  }
}

/** Turn a vector of World (z up) into three's frame (y up), in place. */
export function yUp(vector: Vector3): Vector3 {
  return vector.set(vector.x, vector.z, -vector.y);
}

/** A viewpoint that flies to where it is sent. */
export class Flight {
  readonly now = new Viewpoint();
  private readonly from = new Viewpoint();
  private readonly to = new Viewpoint();
  private began = -Infinity;
  private target = "";

  /** Go to a place by its name, the first one at once; a place that moves is followed. */
  go(name: string, place: CameraPose, now: number): void {
    if (name === this.target) {
      this.to.take(place);
      return;
    }
    const isFirst = this.target === "";
    this.target = name;
    this.to.take(place);
    this.from.copy(isFirst ? this.to : this.now);
    this.now.copy(this.from);
    this.began = now;
  }

  /** Fly on; return whether it still moves. */
  advance(now: number): boolean {
    const share = Math.min(1, (now - this.began) / FLIGHT_S);
    this.now.between(this.from, this.to, share * share * (3 - 2 * share));
    return share < 1;
  }
}
