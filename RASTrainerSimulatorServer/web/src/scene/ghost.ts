/** An earlier trial next to the arm: translucent doubles of its last link and tool. */

import { GHOST_OPACITY } from "../generated";
import { Group, Mesh, MeshLambertMaterial, type Object3D } from "three";

import { PoseStream } from "./pose_stream";
import { COLORS, type SceneModel } from "./scene_model";

export type GhostPoses = Readonly<Record<string, readonly number[]>>;

export class Ghost {
  private readonly material = new MeshLambertMaterial({ color: COLORS.ghost, transparent: true, opacity: GHOST_OPACITY });
  private model: SceneModel | null = null;
  private names: readonly string[] = [];
  private doubles: readonly Object3D[] = [];
  private poses = new PoseStream(0);

  /** Take where the ghost is at a simulated time (s) that arrived at `now` (s); null hides it. */
  put(time: number, poses: GhostPoses | null, now: number): void {
    const names = Object.keys(poses ?? {});
    if (names.join() !== this.names.join()) {
      this.names = names;
      this.poses = new PoseStream(names.length);
      this.remove();
    }
    if (poses !== null) this.poses.put(time, Object.values(poses), now);
  }

  /** Place the ghost in a scene as it is to be seen at `now` (s). */
  show(model: SceneModel, now: number): void {
    if (model !== this.model) this.remove();
    this.model = model;
    if (this.doubles.length !== this.names.length) this.doubles = this.names.map((name) => this.double(model, name));
    this.poses.place(this.doubles, now);
  }

  private double(model: SceneModel, name: string): Object3D {
    const double = new Group();
    model.node(name)?.traverse((node) => {
      if (node instanceof Mesh) double.add(new Mesh(node.geometry, this.material));
    });
    model.root.add(double);
    return double;
  }

  private remove(): void {
    for (const double of this.doubles) double.removeFromParent();
    this.doubles = [];
  }
}
