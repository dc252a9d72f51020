/** Keeps panels from covering tip and next point in a flat picture: those that would are seen through. */

import { type PerspectiveCamera, Vector3 } from "three";

import { byId } from "../elements";
import type { SceneModel } from "../scene/scene_model";
import type { StateNews } from "../generated";
import { yUp } from "../scene/viewpoint";

const PANELS = ["status", "instruction", "warnings", "inset", "guiding", "hints", "control"];
/** A panel that comes so near to tip or point, in pixels, covers it. */
const COVERS = 16;
/** A part that does stays clear until it is so much farther away, so that it does not flicker. */
const FLICKER = 16;

export class ClearSight {
  private readonly point = new Vector3();

  /** Let tip and next point be seen in the picture of a camera, while the trainee works. */
  show(model: SceneModel, camera: PerspectiveCamera, state: StateNews, isWorking: boolean): void {
    const tip = model.node("tool")?.position;
    const isTrial = isWorking && state.phase !== "idle";
    const next = isTrial ? model.next(state.next, this.point) : null;
    const places = [isTrial ? tip : null, next].flatMap((place) => (place ? [pixels(place, camera)] : []));
    for (const id of PANELS) {
      const panel = byId(id);
      const box = panel.getBoundingClientRect();
      const margin = COVERS + (panel.classList.contains("clear") ? FLICKER : 0);
      const covers = ([x, y]: readonly [number, number]) =>
        x > box.left - margin && x < box.right + margin && y > box.top - margin && y < box.bottom + margin;
      panel.classList.toggle("clear", box.height > 0 && places.some(covers));
    }
  }
}

/** Return where a place in World, m, is in the window; far outside where it is behind the camera. */
function pixels(place: Vector3, camera: PerspectiveCamera): readonly [number, number] {
  yUp(seen.copy(place)).project(camera);
  if (seen.z > 1) return [-Infinity, -Infinity];
  return [(0.5 + seen.x / 2) * window.innerWidth, (0.5 - seen.y / 2) * window.innerHeight];
}

const seen = new Vector3();
