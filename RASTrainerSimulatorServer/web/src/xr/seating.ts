/** The panels' place and direction: it follows the person, but not each small move. */

import { Vector3 } from "three";

/** A turn or a move of the person beyond which the panels come after them. */
const TURN_RAD = 0.6;
const MOVE_M = 0.25;
/** So near above the head there is no way toward it; then the panels stand where the eyes look. */
const NEAREST_M = 0.15;

export class Seating {
  readonly eyes = new Vector3();
  /** Level unit vector: the panels' middle. */
  readonly ahead = new Vector3(0, 0, -1);
  /** Middle of the patient's head. */
  readonly focus = new Vector3();
  private isMenu = false;
  private readonly wanted = new Vector3();

  /** Stand at a place, regardless of the person's earlier moves. */
  put(eyes: Vector3, ahead: Vector3, focus: Vector3): void {
    this.eyes.copy(eyes);
    this.ahead.copy(ahead);
    this.focus.copy(focus);
  }

  /**
   * Follow the person's eyes and their level `gaze`; return whether the panels have to be rearranged.
   * Menus come up in the line of sight; facts for the work stand around the head.
   */
  follow(eyes: Vector3, gaze: Vector3, isMenu: boolean): boolean {
    const toHead = this.wanted.subVectors(this.focus, eyes).setY(0);
    if (isMenu || toHead.length() < NEAREST_M) this.wanted.copy(gaze);
    else toHead.normalize();
    const hasTurned = this.wanted.angleTo(this.ahead) > TURN_RAD;
    if (isMenu === this.isMenu && !hasTurned && eyes.distanceTo(this.eyes) <= MOVE_M) return false;
    this.isMenu = isMenu;
    this.eyes.copy(eyes);
    this.ahead.copy(this.wanted);
    return true;
  }
}
