/** Fewer, larger meshes: what moves together is drawn in one go, its colors kept per vertex. */

import {
  BufferAttribute, Color, Mesh, MeshBasicMaterial, MeshLambertMaterial, MeshStandardMaterial, type BufferGeometry,
  type Object3D,
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";

import { isSoftware } from "./graphics";

/** A batch's answer to light: matt for the room, glossy for bodies that are seen closely. */
export type Finish = "matt" | "glossy";

/**
 * Replace the meshes at and below `root`, except those in `apart`, with a lit mesh and a
 * glowing mesh, and return these two. Nothing below `root` may be moved afterward.
 */
export function batch(root: Object3D, finish: Finish, apart: ReadonlySet<Object3D>): Mesh[] {
  const lit: BufferGeometry[] = [];
  const glowing: BufferGeometry[] = [];
  root.updateMatrixWorld(true);
  const toRoot = root.matrixWorld.clone().invert();
  for (const mesh of meshesOf(root, apart)) {
    const color = ownColor(mesh);
    const geometry = mesh.geometry.clone();
    geometry.applyMatrix4(toRoot.clone().multiply(mesh.matrixWorld));
    (color.glows ? glowing : lit).push(painted(geometry, color.color));
    mesh.geometry.dispose();
    if (mesh !== root) mesh.removeFromParent();
  }
  const made: Mesh[] = [];
  if (lit.length > 0) made.push(new Mesh(mergeGeometries(lit), material(finish)));
  if (glowing.length > 0) {
    made.push(new Mesh(mergeGeometries(glowing), new MeshBasicMaterial({ vertexColors: true, toneMapped: false })));
  }
  if (made.length > 0) root.add(...made);
  return made;
}

/** Return the color of a mesh of the GLB, and whether it needs no light. */
export function ownColor(mesh: Mesh): { color: Color; glows: boolean } {
  const given = mesh.material as MeshStandardMaterial;
  const glows = given.emissive !== undefined && given.emissive.getHex() !== 0;
  return { color: (glows ? given.emissive : given.color).clone(), glows };
}

function meshesOf(root: Object3D, apart: ReadonlySet<Object3D>): Mesh[] {
  if (apart.has(root)) return [];
  const below = root.children.flatMap((child) => meshesOf(child, apart));
  return root instanceof Mesh ? [root, ...below] : below;
}

function painted(geometry: BufferGeometry, color: Color): BufferGeometry {
  const count = geometry.getAttribute("position").count;
  const colors = new Float32Array(3 * count);
  for (let index = 0; index < count; index++) color.toArray(colors, 3 * index);
  geometry.setAttribute("color", new BufferAttribute(colors, 3));
  return geometry;
}

function material(finish: Finish): MeshLambertMaterial | MeshStandardMaterial {
  return finish === "matt" || isSoftware
    ? new MeshLambertMaterial({ vertexColors: true })
    : new MeshStandardMaterial({ vertexColors: true, roughness: 0.42, metalness: 0.1 });
}
