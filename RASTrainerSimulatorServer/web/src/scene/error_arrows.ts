/** The errors of the touches as arrows on the head, and the names of checkpoints. */

import {
  CanvasTexture, CylinderGeometry, Group, Mesh, MeshBasicMaterial, SphereGeometry, Sprite, SpriteMaterial,
  SRGBColorSpace, Vector3, type Object3D,
} from "three";

import { ARROW_BALL_M, ARROW_RADIUS_M, TONES, type ErrorArrow } from "../generated";
import { COLORS, Pen } from "../panels/pen";

const ALONG = new Vector3(0, 1, 0);
/** Height of a name, m, and of its canvas, pixels; how far it is above the middle of its ball, in heights. */
const NAME_HIGH = 0.009;
const NAME_PIXELS = 64;
const NAME_ABOVE = 0.5;

export class ErrorArrows {
  readonly group = new Group();
  private readonly shaft = new CylinderGeometry(ARROW_RADIUS_M, ARROW_RADIUS_M, 1, 12);
  private readonly ball = new SphereGeometry(ARROW_BALL_M, 12, 8);
  private shown = "[]";

  /** Show these in place of others, as children of `world`; return whether they are others. */
  show(arrows: readonly ErrorArrow[], world: Object3D): boolean {
    if (this.group.parent !== world) world.add(this.group);
    const content = JSON.stringify(arrows);
    if (content === this.shown) return false;
    this.shown = content;
    for (const child of this.group.children) if (child instanceof Sprite) dispose(child);
    this.group.clear();
    for (const arrow of arrows) this.draw(arrow);
    return true;
  }

  private draw(arrow: ErrorArrow): void {
    const begin = new Vector3(...arrow.begin);
    const end = new Vector3(...arrow.end);
    const material = new MeshBasicMaterial({ color: TONES[arrow.tone], toneMapped: false });
    const ball = new Mesh(this.ball, material);
    ball.position.copy(end);
    this.group.add(ball);
    if (arrow.name !== "") this.group.add(nameAt(end, arrow));
    const length = begin.distanceTo(end);
    if (length === 0) return;
    const shaft = new Mesh(this.shaft, material);
    shaft.scale.y = length;
    shaft.position.copy(begin).lerp(end, 0.5);
    shaft.quaternion.setFromUnitVectors(ALONG, end.clone().sub(begin).normalize());
    this.group.add(shaft);
  }
}

/** Return a name above a ball, which faces every view. */
function nameAt(place: Vector3, { name, tone }: ErrorArrow): Sprite {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d")!;
  const style = { size: 0.7 * NAME_PIXELS, color: TONES[tone], isBold: true };
  canvas.width = Math.ceil(new Pen(context).width(name, style)) + NAME_PIXELS / 2;
  canvas.height = NAME_PIXELS;
  // A canvas that gets another size forgets how it was to be written on.
  const pen = new Pen(context);
  pen.box(0, 0, canvas.width, canvas.height, COLORS.night, NAME_PIXELS / 4);
  pen.line(name, NAME_PIXELS / 4, NAME_PIXELS / 2, style);
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(new SpriteMaterial({ map, toneMapped: false }));
  sprite.position.copy(place);
  sprite.center.set(0.5, -NAME_ABOVE);
  sprite.scale.set((NAME_HIGH * canvas.width) / NAME_PIXELS, NAME_HIGH, 1);
  return sprite;
}

function dispose({ material }: Sprite): void {
  material.map?.dispose();
  material.dispose();
}
