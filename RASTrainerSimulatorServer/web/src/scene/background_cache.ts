/** Keeps the picture of what stands still, color and depth: only what moves is drawn each time. */

import { type Camera, type Scene, SRGBColorSpace, type WebGLRenderer, WebGLRenderTarget } from "three";

/** Layer of what stands still. XR uses 1 and 2 for the eyes. */
export const STATIC = 3;
const DYNAMIC = 0;
const SAMPLES = 4;
/** Time without a change after which what stands still is drawn well and kept, s. */
const SETTLED_S = 0.15;
/** While all of it moves, a picture of more pixels is drawn at half the resolution. */
const MOST_PIXELS = 1.2e6;

interface Box {
  readonly left: number;
  readonly bottom: number;
  readonly width: number;
  readonly height: number;
}

export class BackgroundCache {
  private readonly kept = target(SAMPLES);
  private readonly picture = target(0);
  /** Inputs of the kept background, and of the last picture. */
  private keptContent = "";
  private content = "";
  private changed = -Infinity;

  constructor(private readonly renderer: WebGLRenderer) {
    renderer.domElement.addEventListener("webglcontextrestored", () => (this.keptContent = ""));
  }

  /**
   * Draw a scene into a box of the canvas, in pixels; return whether a better picture is to follow.
   *
   * `content` names everything else, besides camera and box, on which the background depends.
   */
  draw(scene: Scene, camera: Camera, box: Box, content: string, now: number): boolean {
    const { renderer } = this;
    const { width, height } = box;
    camera.updateMatrixWorld();
    const shown = [width, height, ...camera.matrixWorld.elements, ...camera.projectionMatrix.elements, content].join();
    if (shown !== this.content) {
      this.content = shown;
      this.changed = now;
    }
    const isKept = shown === this.keptContent;
    const isSettled = isKept || now - this.changed >= SETTLED_S;
    const scale = !isSettled && width * height > MOST_PIXELS ? 0.5 : 1;
    this.picture.setSize(Math.ceil(scale * width), Math.ceil(scale * height));
    const { background } = scene;
    renderer.autoClear = true;
    if (!isSettled) {
      camera.layers.enable(STATIC);
      this.render(this.picture, scene, camera);
    } else {
      if (!isKept) {
        this.kept.setSize(width, height);
        camera.layers.set(STATIC);
        this.render(this.kept, scene, camera);
        this.keptContent = shown;
      }
      this.copy(this.kept, this.picture);
      camera.layers.set(DYNAMIC);
      scene.background = null;
      renderer.autoClear = false;
      this.render(this.picture, scene, camera);
    }
    scene.background = background;
    renderer.autoClear = true;
    this.show(box);
    return !isSettled;
  }

  private render(into: WebGLRenderTarget, scene: Scene, camera: Camera): void {
    this.renderer.setRenderTarget(into);
    this.renderer.render(scene, camera);
  }

  private copy(from: WebGLRenderTarget, into: WebGLRenderTarget): void {
    const context = this.context;
    this.renderer.setRenderTarget(into);
    this.bind(context.READ_FRAMEBUFFER, from);
    this.bind(context.DRAW_FRAMEBUFFER, into);
    const { width, height } = into;
    const all = context.COLOR_BUFFER_BIT | context.DEPTH_BUFFER_BIT;
    context.blitFramebuffer(0, 0, width, height, 0, 0, width, height, all, context.NEAREST);
  }

  private show({ left, bottom, width, height }: Box): void {
    const context = this.context;
    const { picture, renderer } = this;
    renderer.setRenderTarget(null);
    renderer.state.setScissorTest(false);
    this.bind(context.READ_FRAMEBUFFER, picture);
    renderer.state.bindFramebuffer(context.DRAW_FRAMEBUFFER, null);
    const filter = picture.width === width ? context.NEAREST : context.LINEAR;
    const place = [left, bottom, left + width, bottom + height] as const;
    context.blitFramebuffer(0, 0, picture.width, picture.height, ...place, context.COLOR_BUFFER_BIT, filter);
    renderer.state.bindFramebuffer(context.READ_FRAMEBUFFER, null);
  }

  private bind(where: number, into: WebGLRenderTarget): void {
    const { __webglFramebuffer: framebuffer } = this.renderer.properties.get(into) as { __webglFramebuffer: WebGLFramebuffer };
    this.renderer.state.bindFramebuffer(where, framebuffer);
  }

  private get context(): WebGL2RenderingContext {
    return this.renderer.getContext() as WebGL2RenderingContext;
  }
}

/** Return a target that is drawn as the canvas would be: tone-mapped, in sRGB. */
function target(samples: number): WebGLRenderTarget {
  const format = { colorSpace: SRGBColorSpace, internalFormat: "RGBA8" } as const;
  const made = new WebGLRenderTarget(1, 1, { samples, resolveDepthBuffer: true, ...format });
  return Object.assign(made, { isXRRenderTarget: true });
}
