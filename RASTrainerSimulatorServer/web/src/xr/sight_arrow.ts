/** An arrow in front of the eyes toward the next point or the tool, if out of sight. */

import { ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, type PerspectiveCamera, Vector3 } from "three";

import { yUp } from "../scene/viewpoint";

/** Points farther from the middle of the view than this (rad) are out of sight. */
const IN_SIGHT_RAD = 0.45;
/** Place below the middle of the view, where it covers neither the tip nor a panel: in front, m. */
const AHEAD_M = 0.6;
const LENGTH_M = 0.1;
/** After the panels. */
const ORDER = 30;

/** How an arrow looks: how far below the middle of the view it is (m), and the radius of its shaft (m). */
export interface ArrowLook {
  color: number;
  down: number;
  radius: number;
}

export class SightArrow {
  /** In the room. */
  readonly group = new Group();
  private readonly place = new Vector3();
  private readonly eyes = new Vector3();
  private readonly gaze = new Vector3();
  private readonly down = new Vector3();

  constructor(private readonly look: ArrowLook) {
    const { color, radius } = look;
    const material = new MeshBasicMaterial({ color, toneMapped: false, depthTest: false });
    const shaft = new Mesh(new CylinderGeometry(radius, radius, 0.6 * LENGTH_M), material);
    const head = new Mesh(new ConeGeometry(0.02, 0.4 * LENGTH_M), material);
    shaft.position.y = -0.2 * LENGTH_M;
    head.position.y = 0.3 * LENGTH_M;
    for (const part of [shaft, head]) {
      part.renderOrder = ORDER;
      this.group.add(part);
    }
    this.group.visible = false;
  }

  /** Point at a place in World, m, if it is out of the sight of eyes at `camera`; null for none. */
  show(found: Vector3 | null, camera: PerspectiveCamera): void {
    this.group.visible = false;
    if (found === null) return;
    camera.getWorldPosition(this.eyes);
    camera.getWorldDirection(this.gaze);
    yUp(this.place.copy(found));
    if (this.gaze.angleTo(this.down.subVectors(this.place, this.eyes)) <= IN_SIGHT_RAD) return;
    this.group.visible = true;
    this.down.setFromMatrixColumn(camera.matrixWorld, 1).multiplyScalar(-this.look.down);
    this.group.position.copy(this.eyes).addScaledVector(this.gaze, AHEAD_M).add(this.down);
    this.group.quaternion.setFromUnitVectors(UP, this.place.sub(this.group.position).normalize());
  }

  dispose(): void {
    this.group.removeFromParent();
    for (const part of this.group.children as Mesh[]) {
      part.geometry.dispose();
      (part.material as MeshBasicMaterial).dispose();
    }
  }
}

const UP = new Vector3(0, 1, 0);
