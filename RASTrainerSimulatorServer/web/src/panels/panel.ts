/** A panel in the room: a canvas on a rectangle. */

import {
  CanvasTexture, LinearFilter, LinearMipmapLinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry, SRGBColorSpace,
} from "three";

const ANISOTROPY = 4;

export class Panel {
  readonly mesh: Mesh<PlaneGeometry, MeshBasicMaterial>;
  readonly texture: CanvasTexture;

  /** Show a canvas on a rectangle that is `wide` m wide. */
  constructor(
    readonly canvas: HTMLCanvasElement,
    wide: number,
  ) {
    this.texture = new CanvasTexture(canvas);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.anisotropy = ANISOTROPY;
    this.texture.magFilter = LinearFilter;
    this.texture.minFilter = LinearMipmapLinearFilter;
    const geometry = new PlaneGeometry(wide, (wide * canvas.height) / canvas.width);
    const material = new MeshBasicMaterial({ map: this.texture, transparent: true, toneMapped: false });
    this.mesh = new Mesh(geometry, material);
    this.mesh.visible = false;
  }

  dispose(): void {
    this.mesh.removeFromParent();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.texture.dispose();
  }
}
