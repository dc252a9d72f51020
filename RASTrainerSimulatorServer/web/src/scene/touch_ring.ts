/** A ring about the tool's tip that closes as the tip comes nearer to the head. */

import { type Camera, Mesh, MeshBasicMaterial, RingGeometry, type Scene, Vector3 } from "three";

import { CLOSED_RING_M, type StateNews } from "../generated";
import { isTouchError } from "../stream/stages";
import { COLORS, type SceneModel } from "./scene_model";

const INNER = 0.84;
const INNER_ON_SKIN = 0.55;

export class TouchRing {
  private readonly material = new MeshBasicMaterial({ depthTest: false, transparent: true, toneMapped: false });
  private readonly open = new RingGeometry(INNER, 1, 48);
  private readonly closed = new RingGeometry(INNER_ON_SKIN, 1, 48);
  private readonly mesh = new Mesh(this.open, this.material);
  private readonly tip = new Vector3();

  constructor(scene: Scene) {
    this.mesh.renderOrder = 5;
    this.mesh.visible = false;
    scene.add(this.mesh);
  }

  /** Show the ring of a state toward a camera; it is hidden far from the head and while a menu is open. */
  show(model: SceneModel, state: StateNews, camera: Camera, isWorking: boolean): void {
    const tool = model.node("tool");
    const isShown = isWorking && state.touch !== "far" && tool !== undefined;
    this.mesh.visible = isShown;
    if (!isShown) return;
    const isOnSkin = state.touch === "on skin";
    this.mesh.geometry = isOnSkin || state.touch === "pressed" ? this.closed : this.open;
    this.material.color.copy(isTouchError(state.touch) ? COLORS.error : isOnSkin ? COLORS.onSkin : COLORS.near);
    this.mesh.position.copy(tool.getWorldPosition(this.tip));
    camera.getWorldQuaternion(this.mesh.quaternion);
    this.mesh.scale.setScalar(CLOSED_RING_M + Math.max(0, state.clearanceMm) / 1000);
  }
}
