/** The errors of the touches as arrows on the head. */

import { CylinderGeometry, Group, Mesh, MeshBasicMaterial, SphereGeometry, Vector3, type Object3D } from "three";

import type { ErrorArrow } from "../stream/messages";
import { TONES } from "../panels/pen";

/** Of an arrow's shaft, and of the ball at its end, m. */
const RADIUS = 0.001;
const BALL = 0.0022;
const ALONG = new Vector3(0, 1, 0);

export class ErrorArrows {
  readonly group = new Group();
  private readonly shaft = new CylinderGeometry(RADIUS, RADIUS, 1, 12);
  private readonly ball = new SphereGeometry(BALL, 12, 8);
  private shown = "[]";

  /** Show these in place of others, as children of `world`; return whether they are others. */
  show(arrows: readonly ErrorArrow[], world: Object3D): boolean {
    if (this.group.parent !== world) world.add(this.group);
    const content = JSON.stringify(arrows);
    if (content === this.shown) return false;
    this.shown = content;
    this.group.clear();
    for (const arrow of arrows) this.draw(arrow);
    return true;
  }

  private draw(arrow: ErrorArrow): void {
    const begin = new Vector3(...arrow.begin);
    const end = new Vector3(...arrow.end);
    const material = new MeshBasicMaterial({ color: TONES[arrow.tone], toneMapped: false });
    const ball = new Mesh(this.ball, material);
    ball.position.copy(end);
    this.group.add(ball);
    const length = begin.distanceTo(end);
    if (length === 0) return;
    const shaft = new Mesh(this.shaft, material);
    shaft.scale.y = length;
    shaft.position.copy(begin).lerp(end, 0.5);
    shaft.quaternion.setFromUnitVectors(ALONG, end.clone().sub(begin).normalize());
    this.group.add(shaft);
  }
}
