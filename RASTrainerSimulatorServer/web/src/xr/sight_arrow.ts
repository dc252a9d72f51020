/** An arrow before the eyes toward a next point that is out of sight. */

import { TARGET_COLOR } from "../generated";
import { ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, type PerspectiveCamera, Vector3 } from "three";

import type { SceneModel } from "../scene/scene_model";
import { yUp } from "../scene/viewpoint";

/** A point farther from the middle of the view (rad) is out of sight. */
const IN_SIGHT_RAD = 0.45;
/** Below the middle of the view, where it covers neither the tip nor a panel: in front and down, m. */
const AHEAD_M = 0.6;
const DOWN_M = 0.16;
const LENGTH_M = 0.1;
/** After the panels. */
const ORDER = 30;

export class SightArrow {
  /** In the room. */
  readonly group = new Group();
  private readonly point = new Vector3();
  private readonly eyes = new Vector3();
  private readonly gaze = new Vector3();
  private readonly down = new Vector3();

  constructor() {
    const material = new MeshBasicMaterial({ color: TARGET_COLOR, toneMapped: false, depthTest: false });
    const shaft = new Mesh(new CylinderGeometry(0.007, 0.007, 0.6 * LENGTH_M), material);
    const head = new Mesh(new ConeGeometry(0.02, 0.4 * LENGTH_M), material);
    shaft.position.y = -0.2 * LENGTH_M;
    head.position.y = 0.3 * LENGTH_M;
    for (const part of [shaft, head]) {
      part.renderOrder = ORDER;
      this.group.add(part);
    }
    this.group.visible = false;
  }

  /** Point at a fiducial, or without one at the place to draw next, for eyes at `camera`. */
  show(model: SceneModel, camera: PerspectiveCamera, label: string | null, isWanted: boolean): void {
    const found = isWanted ? model.next(label, this.point) : null;
    this.group.visible = false;
    if (found === null) return;
    camera.getWorldPosition(this.eyes);
    camera.getWorldDirection(this.gaze);
    yUp(this.point);
    if (this.gaze.angleTo(this.down.subVectors(this.point, this.eyes)) <= IN_SIGHT_RAD) return;
    this.group.visible = true;
    this.down.setFromMatrixColumn(camera.matrixWorld, 1).multiplyScalar(-DOWN_M);
    this.group.position.copy(this.eyes).addScaledVector(this.gaze, AHEAD_M).add(this.down);
    this.group.quaternion.setFromUnitVectors(UP, this.point.sub(this.group.position).normalize());
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
