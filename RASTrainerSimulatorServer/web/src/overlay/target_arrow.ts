/** An arrow at the picture's edge toward a next point that is out of sight. */

import { type PerspectiveCamera, Vector3 } from "three";

import { byId } from "../elements";
import type { SceneModel } from "../scene/scene_model";
import { yUp } from "../scene/viewpoint";

/** How much of the picture, from its middle, counts as in sight. */
const IN_SIGHT = 0.9;
const REACH = 0.86;

export class TargetArrow {
  private readonly point = new Vector3();
  private readonly tip = new Vector3();
  private shown = "";

  /** Point at a fiducial, or without one at the place to draw next over the skin. */
  show(model: SceneModel | null, camera: PerspectiveCamera, label: string | null, isWanted: boolean): void {
    const place = byId("target");
    const found = isWanted ? (model?.next(label, this.point) ?? null) : null;
    const tool = model?.node("tool");
    if (found === null || tool === undefined) {
      place.hidden = true;
      return;
    }
    const distance = this.tip.copy(tool.position).distanceTo(this.point);
    yUp(this.point).project(camera);
    const isBehind = this.point.z > 1;
    const isSeen = Math.max(Math.abs(this.point.x), Math.abs(this.point.y)) <= IN_SIGHT;
    place.hidden = isSeen && !isBehind;
    if (place.hidden) return;
    const sign = isBehind ? -1 : 1;
    const across = sign * this.point.x * camera.aspect;
    const up = sign * this.point.y;
    const reach = REACH * Math.min(camera.aspect / Math.abs(across), 1 / Math.abs(up));
    const name = label === null ? "" : `${label}: `;
    const text = `${name}${Math.round(distance * 200) * 5} mm`;
    const left = 50 + (50 * across * reach) / camera.aspect;
    const top = 50 - 50 * up * reach;
    this.place(place, text, left, top, Math.atan2(-up, across));
  }

  private place(place: HTMLElement, text: string, left: number, top: number, angle: number): void {
    const now = `${text} ${left.toFixed(1)} ${top.toFixed(1)}`;
    if (now === this.shown) return;
    this.shown = now;
    place.style.left = `${left}%`;
    place.style.top = `${top}%`;
    (place.firstElementChild as HTMLElement).style.transform = `rotate(${angle}rad)`;
    place.lastElementChild!.textContent = text;
  }
}
