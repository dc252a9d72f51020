/** The close-up camera as a magnified picture in the room: it follows the tool's tip. */

import {
  LinearFilter,
  Mesh,
  MeshBasicMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  SRGBColorSpace,
  Vector3,
  WebGLRenderTarget,
  type Object3D,
} from "three";

import type { Stage } from "../stage";
import { Viewpoint } from "../viewpoint";

const WIDTH = 768;
const HEIGHT = 480;
const ANGLE_DEG = 17;
/** A picture of its own in every so many pictures: its price is spread over them. */
const EVERY = 3;

export class CloseUp {
  readonly mesh: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private readonly target = new WebGLRenderTarget(WIDTH, HEIGHT, { samples: 4 });
  private readonly camera = new PerspectiveCamera(ANGLE_DEG, WIDTH / HEIGHT, 0.05, 6);
  private readonly place = new Viewpoint();
  private readonly tip = new Vector3();
  private turn = 0;

  constructor(wide: number) {
    this.target.texture.colorSpace = SRGBColorSpace;
    this.target.texture.minFilter = LinearFilter;
    const material = new MeshBasicMaterial({ map: this.target.texture, toneMapped: false });
    this.mesh = new Mesh(new PlaneGeometry(wide, (wide * HEIGHT) / WIDTH), material);
  }

  /** Draw the picture if it is its turn; `hidden` is not to be seen in it. */
  draw(stage: Stage, hidden: readonly Object3D[]): void {
    const { model, renderer } = stage;
    const camera = model?.news.cameras["close-up"];
    const tool = model?.node("tool");
    if (!this.mesh.visible || camera === undefined || tool === undefined) return;
    this.turn = (this.turn + 1) % EVERY;
    if (this.turn !== 0) return;
    this.place.take(camera);
    this.place.focus.copy(tool.getWorldPosition(this.tip));
    this.place.angle = ANGLE_DEG;
    this.place.look(this.camera, WIDTH / HEIGHT);
    for (const object of hidden) object.visible = false;
    renderer.xr.enabled = false;
    const before = renderer.getRenderTarget();
    renderer.setRenderTarget(this.target);
    renderer.render(stage.scene, this.camera);
    renderer.setRenderTarget(before);
    renderer.xr.enabled = true;
    for (const object of hidden) object.visible = true;
  }

  dispose(): void {
    this.mesh.removeFromParent();
    this.target.dispose();
  }
}
