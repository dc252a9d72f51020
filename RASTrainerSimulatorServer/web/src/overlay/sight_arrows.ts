/** Arrows at the picture's edge toward the next point and the tool, if out of sight. */

import { type PerspectiveCamera, Vector3 } from "three";

import { byId } from "../elements";
import { IN_SIGHT_SHARE } from "../generated";
import { yUp } from "../scene/viewpoint";
import { say } from "../texts";

/** How much of the picture, from its middle, counts as in sight. */
const REACH = 0.86;
/** Half the height of an arrow with its text, pixels. */
const ROOM = 40;

export class SightArrows {
  private readonly target = new EdgeArrow("target");
  private readonly tool = new EdgeArrow("tool");

  /** Point at places in World, m: the tool, and the next point, which has a `label`, or the place to draw next. */
  show(tip: Vector3 | null, next: Vector3 | null, label: string | null, camera: PerspectiveCamera): void {
    const distance = tip && next ? `${Math.round(tip.distanceTo(next) * 200) * 5} mm` : "";
    this.target.show(next, camera, label === null ? distance : `${label}: ${distance}`);
    this.tool.show(tip, camera, say("tool"));
  }
}

class EdgeArrow {
  private readonly point = new Vector3();
  private shown = "";

  constructor(private readonly id: "target" | "tool") {}

  /** Point at a place in World, m, if it is out of sight; null for none. */
  show(found: Vector3 | null, camera: PerspectiveCamera, text: string): void {
    const place = byId(this.id);
    if (found === null) {
      place.hidden = true;
      return;
    }
    yUp(this.point.copy(found)).project(camera);
    const isBehind = this.point.z > 1;
    const isSeen = Math.max(Math.abs(this.point.x), Math.abs(this.point.y)) <= IN_SIGHT_SHARE;
    place.hidden = isSeen && !isBehind;
    if (place.hidden) return;
    const sign = isBehind ? -1 : 1;
    const across = sign * this.point.x * camera.aspect;
    const up = sign * this.point.y;
    const reach = REACH * Math.min(camera.aspect / Math.abs(across), 1 / Math.abs(up));
    const left = 50 + (50 * across * reach) / camera.aspect;
    const top = between(50 - 50 * up * reach);
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

/** Keep a height, % from the window's top, between the texts above and below. */
function between(top: number): number {
  const above = byId("words").getBoundingClientRect().bottom + ROOM;
  const below = byId("hints").getBoundingClientRect().top - ROOM;
  const share = 100 / window.innerHeight;
  return Math.max(Math.min(top, below * share), above * share);
}
