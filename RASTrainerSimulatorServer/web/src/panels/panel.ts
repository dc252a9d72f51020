/** A panel in the room: a canvas on a rectangle, painted when its content has changed. */

import {
  CanvasTexture,
  LinearFilter,
  LinearMipmapLinearFilter,
  Mesh,
  MeshBasicMaterial,
  PlaneGeometry,
  SRGBColorSpace,
  type Vector2,
} from "three";

import { Pen } from "./pen";

const ANISOTROPY = 4;

/** A part that can be chosen by pointing at it, in pixels of the canvas. */
export interface Region {
  readonly name: string;
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export class Panel {
  readonly mesh: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private readonly context: CanvasRenderingContext2D;
  private readonly texture: CanvasTexture;
  private regions: readonly Region[] = [];
  private shown = "";

  /** Make a panel of `width` × `height` pixels, `wide` m wide. */
  constructor(
    readonly width: number,
    readonly height: number,
    wide: number,
  ) {
    const canvas = document.createElement("canvas");
    canvas.width = width;
    canvas.height = height;
    this.context = canvas.getContext("2d")!;
    this.texture = new CanvasTexture(canvas);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.anisotropy = ANISOTROPY;
    this.texture.magFilter = LinearFilter;
    this.texture.minFilter = LinearMipmapLinearFilter;
    const geometry = new PlaneGeometry(wide, (wide * height) / width);
    const material = new MeshBasicMaterial({
      map: this.texture,
      transparent: true,
      toneMapped: false,
    });
    this.mesh = new Mesh(geometry, material);
    this.mesh.userData.panel = this;
  }

  /** Paint the panel if `content`, which describes all that is painted, has changed. */
  show(content: string, paint: (pen: Pen) => readonly Region[] | void): void {
    if (content === this.shown) return;
    this.shown = content;
    this.context.clearRect(0, 0, this.width, this.height);
    this.regions = paint(new Pen(this.context)) ?? [];
    this.texture.needsUpdate = true;
  }

  /** Return the name of the part at a texture coordinate, "" for none. */
  at(uv: Vector2): string {
    const x = uv.x * this.width;
    const y = (1 - uv.y) * this.height;
    for (const region of this.regions) {
      const isAcross = x >= region.x && x <= region.x + region.width;
      if (isAcross && y >= region.y && y <= region.y + region.height) return region.name;
    }
    return "";
  }

  dispose(): void {
    this.mesh.removeFromParent();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.texture.dispose();
  }
}
