/** A controller's body: a dark capsule behind the origin of its ray, along −z. */

import { CapsuleGeometry, Group, Mesh, MeshLambertMaterial } from "three";

export function controllerBody(): Group {
  const body = new Mesh(
    new CapsuleGeometry(0.018, 0.09, 4, 10).rotateX(Math.PI / 2),
    new MeshLambertMaterial({ color: 0x2a3444 }),
  );
  body.position.z = 0.05;
  return new Group().add(body);
}
