/** Keeps panels from covering tip and next point in a flat picture: those that would are seen through. */

import type { PerspectiveCamera, Vector3 } from "three";

import { byId } from "../elements";
import { yUp } from "../scene/viewpoint";

const PANELS = ["status", "instruction", "warnings", "inset", "guiding", "hints", "control"];
/** A panel that comes so near to tip or point, in pixels, covers it. */
const COVERS = 16;
/** A part that does stays clear until it is so much farther away, so that it does not flicker. */
const FLICKER = 16;

/** Let places in World, m, be seen in the picture of a camera. */
export function clearSight(places: readonly Vector3[], camera: PerspectiveCamera): void {
  const seen = places.map((place) => pixels(place, camera));
  for (const id of PANELS) {
    const panel = byId(id);
    const box = panel.getBoundingClientRect();
    const margin = COVERS + (panel.classList.contains("clear") ? FLICKER : 0);
    const covers = ([x, y]: readonly [number, number]) =>
      x > box.left - margin && x < box.right + margin && y > box.top - margin && y < box.bottom + margin;
    panel.classList.toggle("clear", box.height > 0 && seen.some(covers));
  }
}

/** Return where a place in World, m, is in the window; far outside where it is behind the camera. */
function pixels(place: Vector3, camera: PerspectiveCamera): readonly [number, number] {
  const { x, y, z } = yUp(place.clone()).project(camera);
  return z > 1 ? [-Infinity, -Infinity] : [(0.5 + x / 2) * window.innerWidth, (0.5 - y / 2) * window.innerHeight];
}
