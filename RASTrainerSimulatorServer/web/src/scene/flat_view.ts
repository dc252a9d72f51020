/** The picture on a flat display: one camera fills it, the other has a corner. */

import { PerspectiveCamera, Vector2 } from "three";

import type { CameraPose, SceneNews, StateNews } from "../generated";
import { BackgroundCache, STATIC } from "./background_cache";
import { isSoftware } from "./graphics";
import { hasGuide } from "../stream/stages";
import type { Stage } from "./stage";
import { Flight, Viewpoint } from "./viewpoint";

/** Name of the view along the skin. */
export const BESIDE = "beside";
/** Name of the view through the eyes of who wears a headset. */
const HEADSET = "headset";
/** Name of the view across the line of a procedure. */
export const ACROSS = "across";
const NEAR = 0.05;
const FAR = 12;

export class FlatView {
  readonly camera = new PerspectiveCamera(30, 1, NEAR, FAR);
  private readonly other = new PerspectiveCamera(30, 1, NEAR, FAR);
  private readonly flight = new Flight();
  private readonly inset = new Viewpoint();
  private readonly size = new Vector2();
  private scene: SceneNews | null = null;
  private chosen = "";
  private isBeside = false;
  private hasLine = false;
  /** Bodies that are transparent in the picture, and in the inset. */
  private readonly caches: Record<"view" | "inset", BackgroundCache> | null;
  private covers: Record<"view" | "inset", readonly string[]> = { view: [], inset: [] };

  constructor(
    private readonly stage: Stage,
    private readonly frame: HTMLElement,
  ) {
    const { renderer } = stage;
    this.caches = isSoftware ? { view: new BackgroundCache(renderer), inset: new BackgroundCache(renderer) } : null;
    for (const camera of [this.camera, this.other]) camera.layers.enable(STATIC);
  }

  take(scene: SceneNews): void {
    this.scene = scene;
    this.chosen = "";
  }

  /** Name of the inset's view, "" for none. */
  get insetName(): string {
    if (!this.isBeside) return this.otherCamera;
    return this.hasLine ? ACROSS : BESIDE;
  }

  private get otherCamera(): string {
    return Object.keys(this.scene?.cameras ?? {}).find((name) => name !== this.chosen) ?? "";
  }

  /** Look as the simulator says, or through the eyes of who wears a headset. */
  choose(state: StateNews, now: number, headset: CameraPose | null): void {
    if (this.scene?.cameras[state.camera] === undefined) return;
    this.chosen = state.camera;
    if (headset === null) this.flight.go(state.camera, state.view, now);
    else this.flight.go(HEADSET, headset, now);
    const { view, inset, headset: headsetCovers } = state.translucent;
    this.covers = { view: headset === null ? view : headsetCovers, inset };
    this.isBeside = state.inset !== null;
    this.hasLine = hasGuide(state);
    const other = state.inset ?? this.scene.cameras[this.otherCamera];
    if (other !== undefined) this.inset.take(other);
  }

  /** Fit the picture to the window, and let its camera fly; return whether either changed it. */
  advance(now: number): boolean {
    const isFitted = this.fit();
    const isFlying = this.flight.advance(now);
    this.flight.now.look(this.camera, this.size.x / this.size.y);
    return isFitted || isFlying;
  }

  /** Fit the picture to the window; return whether it had to be changed. */
  private fit(): boolean {
    const { renderer } = this.stage;
    const ratio = Math.min(2, window.devicePixelRatio);
    renderer.getSize(this.size);
    if (
      this.size.x === window.innerWidth &&
      this.size.y === window.innerHeight &&
      renderer.getPixelRatio() === ratio
    ) {
      return false;
    }
    renderer.setPixelRatio(ratio);
    renderer.setSize(window.innerWidth, window.innerHeight);
    renderer.getSize(this.size);
    return true;
  }

  /** Draw, with the other camera in the corner if it is wanted; return whether a better picture is to follow. */
  draw(hasInset: boolean, now: number): boolean {
    const { x: width, y: height } = this.size;
    const isUnfinished = this.drawInto("view", this.camera, new DOMRect(0, 0, width, height), now);
    if (!hasInset) return isUnfinished;
    const box = this.frame.getBoundingClientRect();
    // A low window has no room for it next to the bull's-eye, and the covered parts come first.
    if (box.height === 0 || this.frame.classList.contains("clear")) return isUnfinished;
    this.inset.look(this.other, box.width / box.height);
    return this.drawInto("inset", this.other, box, now) || isUnfinished;
  }

  private drawInto(place: "view" | "inset", camera: PerspectiveCamera, box: DOMRect, now: number): boolean {
    const { renderer, scene, model } = this.stage;
    const bottom = this.size.y - box.bottom;
    model?.seeThrough(this.covers[place]);
    if (this.caches !== null) {
      const [left, low, width, height] = [box.left, bottom, box.width, box.height].map((length) =>
        Math.round(length * renderer.getPixelRatio()),
      ) as [number, number, number, number];
      const content = model?.backgroundContent ?? "";
      return this.caches[place].draw(scene, camera, { left, bottom: low, width, height }, content, now);
    }
    renderer.setScissorTest(place === "inset");
    renderer.setViewport(box.left, bottom, box.width, box.height);
    renderer.setScissor(box.left, bottom, box.width, box.height);
    renderer.render(scene, camera);
    renderer.setScissorTest(false);
    return false;
  }
}
