/** A magnified picture in the room: along the skin where a touch is to be judged, else of the tool's tip. */

import {
  LinearFilter, Mesh, MeshBasicMaterial, PerspectiveCamera, PlaneGeometry, SRGBColorSpace, Vector3, WebGLRenderTarget,
  type Object3D,
} from "three";

import { COLORS } from "../panels/pen";
import { STATIC } from "../scene/background_cache";
import type { StateNews } from "../generated";
import type { Stage } from "../scene/stage";
import { Viewpoint } from "../scene/viewpoint";

const WIDTH = 768;
const HEIGHT = 480;
const ANGLE_DEG = 10;
/** Width of the dark frame, m, which marks it as a picture. */
const FRAME = 0.012;
/** It is drawn only in every n-th picture, which spreads its cost. */
const EVERY = 3;

export class CloseUp {
  readonly mesh: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private readonly frame: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private readonly target = new WebGLRenderTarget(WIDTH, HEIGHT, { samples: 4 });
  private readonly camera = new PerspectiveCamera(ANGLE_DEG, WIDTH / HEIGHT, 0.05, 6);
  private readonly place = new Viewpoint();
  private readonly tip = new Vector3();
  private turn = 0;

  constructor(wide: number) {
    this.camera.layers.enable(STATIC);
    this.target.texture.colorSpace = SRGBColorSpace;
    this.target.texture.minFilter = LinearFilter;
    const material = new MeshBasicMaterial({ map: this.target.texture, toneMapped: false });
    const high = (wide * HEIGHT) / WIDTH;
    this.mesh = new Mesh(new PlaneGeometry(wide, high), material);
    const dark = new MeshBasicMaterial({ color: COLORS.night, toneMapped: false });
    this.frame = new Mesh(new PlaneGeometry(wide + 2 * FRAME, high + 2 * FRAME), dark);
    this.frame.position.z = -0.003;
    this.mesh.add(this.frame);
  }

  /**
   * Draw the picture if it is its turn, without `hidden`. If the state has an `inset`, the camera looks
   * along the skin from there, also behind the head.
   */
  draw(stage: Stage, hidden: Object3D, { inset, translucent }: StateNews): void {
    const { model, renderer } = stage;
    const camera = model?.news.cameras["close-up"];
    const tool = model?.node("tool");
    if (!this.mesh.visible || camera === undefined || tool === undefined) return;
    this.turn = (this.turn + 1) % EVERY;
    if (this.turn !== 0) return;
    this.place.take(inset ?? camera);
    if (inset === null) {
      this.place.focus.copy(tool.getWorldPosition(this.tip));
      this.place.angle = ANGLE_DEG;
    }
    this.place.look(this.camera, WIDTH / HEIGHT);
    model?.seeThrough(translucent.inset);
    hidden.visible = false;
    renderer.xr.enabled = false;
    const before = renderer.getRenderTarget();
    renderer.setRenderTarget(this.target);
    renderer.render(stage.scene, this.camera);
    renderer.setRenderTarget(before);
    renderer.xr.enabled = true;
    hidden.visible = true;
  }

  dispose(): void {
    this.mesh.removeFromParent();
    for (const mesh of [this.mesh, this.frame]) {
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
    this.target.dispose();
  }
}
