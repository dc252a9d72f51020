/** The trace on the skin: marks, paint around them, and a ring where to draw next. */

import {
  BufferAttribute, Color, Group, InstancedMesh, Matrix4, Mesh, MeshBasicMaterial, OctahedronGeometry, RingGeometry,
  Vector3,
} from "three";

import {
  FULL_PAINT_SHARE, MAX_TRACE_POINTS, TRACE_LIFT_M, TRACE_MARK_M, TRACE_RIM_M, TRACE_RING_M, TRACE_RING_SIDES,
  type TraceNews,
} from "../generated";
import { COLORS, type SceneModel } from "./scene_model";

const OUTWARD = new Vector3(0, 0, 1);

export class TraceMarks {
  private readonly marks = new InstancedMesh(new OctahedronGeometry(TRACE_MARK_M), basic(COLORS.traced), MAX_TRACE_POINTS);
  private readonly ring = new Group();
  private readonly paint = new SkinPaint();
  private points: Vector3[] = [];
  private covered = 0;
  private next: TraceNews["next"] = null;
  private model: SceneModel | null = null;
  private isNew = true;

  constructor() {
    this.marks.count = 0;
    // Its marks lie anywhere on the head, not about its origin.
    this.marks.frustumCulled = false;
    for (const [[inner, outer], color] of [[TRACE_RING_M, COLORS.next], [TRACE_RIM_M, COLORS.traced]] as const) {
      this.ring.add(new Mesh(new RingGeometry(inner, outer, TRACE_RING_SIDES), basic(color)));
    }
  }

  /** Forget the trace: the simulator sends all of it again. */
  reset(): void {
    this.take({ type: "trace", known: 0, points: [], coveredMm: 0, next: null });
  }

  /** Add the new part. */
  take(news: TraceNews): void {
    this.points.length = Math.min(news.known, this.points.length);
    for (const [x, y, z] of news.points) this.points.push(new Vector3(x, y, z).multiplyScalar(0.001));
    this.points.length = Math.min(MAX_TRACE_POINTS, this.points.length);
    this.covered = news.coveredMm / 1000;
    this.next = news.next;
    this.isNew = true;
  }

  /** Show the trace on the head of a scene; return whether the picture changes. */
  show(model: SceneModel): boolean {
    const isOther = model !== this.model;
    if (!isOther && !this.isNew) return false;
    this.model = model;
    this.isNew = false;
    model.node("head")?.add(this.marks, this.ring);
    this.marks.count = this.points.length;
    this.marks.visible = this.points.length > 0;
    this.points.forEach((point, index) => this.marks.setMatrixAt(index, new Matrix4().setPosition(point)));
    this.marks.instanceMatrix.needsUpdate = true;
    this.showNext(model);
    model.paintSkin(this.paint.shares(model.skinVertices, this.points, this.covered));
    return true;
  }

  private showNext(model: SceneModel): void {
    const { next, ring } = this;
    ring.visible = next !== null;
    model.nextPlace = next === null ? null : new Vector3(...next.positionMm).multiplyScalar(0.001);
    if (next === null || model.nextPlace === null) return;
    const normal = new Vector3(...next.normal);
    ring.position.copy(model.nextPlace).addScaledVector(normal, TRACE_LIFT_M);
    ring.quaternion.setFromUnitVectors(OUTWARD, normal);
  }
}

/** Share of paint on each vertex of the skin; computed for new marks only. */
class SkinPaint {
  private vertices: BufferAttribute | null = null;
  private squares = new Float32Array(0);
  private readonly known: Vector3[] = [];

  /** Return shares of 0 to 1; null where nothing is painted. */
  shares(vertices: BufferAttribute | null, points: readonly Vector3[], covered: number): Float32Array | null {
    if (vertices === null || points.length === 0 || covered === 0) return null;
    const isLonger = this.known.every((point, index) => point === points[index]);
    if (vertices !== this.vertices || !isLonger) {
      this.vertices = vertices;
      this.squares = new Float32Array(vertices.count).fill(Infinity);
      this.known.length = 0;
    }
    const at = new Vector3();
    const fresh = points.slice(this.known.length);
    this.known.push(...fresh);
    const shares = new Float32Array(vertices.count);
    for (let index = 0; index < vertices.count; index++) {
      at.fromBufferAttribute(vertices, index);
      let least = this.squares[index]!;
      for (const point of fresh) least = Math.min(least, at.distanceToSquared(point));
      this.squares[index] = least;
      const fading = (1 - Math.sqrt(least) / covered) / (1 - FULL_PAINT_SHARE);
      shares[index] = Math.min(1, Math.max(0, fading));
    }
    return shares;
  }
}

function basic(color: Color): MeshBasicMaterial {
  return new MeshBasicMaterial({ color, toneMapped: false });
}
