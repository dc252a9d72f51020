/** The scene that the simulator made: loaded, batched, moved and colored as its state says. */

import {
  BufferAttribute, Color, Group, Mesh, MeshBasicMaterial, MeshLambertMaterial, MeshStandardMaterial, Vector3,
  type Material, type Object3D,
} from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

import { STATIC } from "./background_cache";
import { isSoftware } from "./graphics";
import { batch, ownColor, type Finish } from "./batch";
import { served } from "../stream/served";
import { CLEAR_SKIN_OPACITY, COVER_OPACITY, INSTRUMENTS, PULSE_COLOR, PULSE_S, SCENE_COLORS, TOOL_NODES, type ProcedureNews, type SceneNews, type StateNews, type TouchStage } from "../generated";
import { isTouchError } from "../stream/stages";

const FIDUCIAL = "fiducial_";
const FURNITURE = ["table", "floor", "room"];
const AT_THE_TOOL = ["guide", "axis", ...INSTRUMENTS];
const PULSE = new Color(...PULSE_COLOR);

export const COLORS = Object.fromEntries(
  Object.entries(SCENE_COLORS).map(([name, [red, green, blue]]) => [name, new Color().setRGB(red, green, blue, "srgb")]),
) as Record<keyof typeof SCENE_COLORS, Color>;

const WHITE = new Color(1, 1, 1);

export class SceneModel {
  /** All of it; its children are in World (x forward, y left, z up), m. */
  readonly root: Object3D;
  /** In the order of the stream's poses. */
  readonly bodies: readonly (Object3D | undefined)[];
  private readonly named = new Map<string, Object3D>();
  private readonly fiducials = new Map<string, Mesh>();
  private readonly waiting = glow(COLORS.waiting);
  private readonly nextMark = glow(COLORS.next);
  private readonly touched = glow(COLORS.touched);
  private readonly tip = glow(COLORS.free);
  private markedNext: string | null = "";
  private markedTouches = -1;
  private pulses = false;
  /** Where to draw next over the skin, in `head`, m. */
  nextPlace: Vector3 | null = null;
  private readonly nextTouch = new Vector3();
  private readonly skinColor = new Color();
  private skinMesh: Mesh | null = null;
  private readonly skin = isSoftware ? new MeshLambertMaterial() : new MeshStandardMaterial({ roughness: 0.6 });
  private readonly noGo: Object3D[] = [];
  /** The skin and the parts within, without fiducials. */
  private readonly inHead: Mesh[] = [];
  private backgroundChanges = 0;
  /** The mesh of each body of the arm, with its material. */
  private readonly arm = new Map<string, readonly (readonly [Mesh, Material | Material[]])[]>();
  private readonly seenThrough = new MeshLambertMaterial({
    vertexColors: true,
    transparent: true,
    opacity: COVER_OPACITY,
    depthWrite: false,
  });

  constructor(
    file: Object3D,
    public news: SceneNews,
    bodies: readonly string[],
  ) {
    file.traverse((node) => this.named.set((node.userData.name as string) ?? node.name, node));
    this.root = this.named.get("world") ?? file;
    this.bodies = bodies.map((name) => this.named.get(name));
    this.prepare(bodies);
  }

  node(name: string): Object3D | undefined {
    return this.named.get(name);
  }

  /** Return where a fiducial, or without one the place to draw next, is in World, m, written into `target`. */
  next(label: string | null, target: Vector3): Vector3 | null {
    const place = label === null ? this.nextPlace?.toArray() : this.news.fiducials[label];
    const head = this.named.get("head");
    if (place === undefined || head === undefined) return null;
    return target.fromArray(place).applyQuaternion(head.quaternion).add(head.position);
  }

  /** Return where tool and next touch are in World, m, while a trial is worked at. */
  placesAtWork(state: StateNews, isWorking: boolean): { tip: Vector3 | null; next: Vector3 | null } {
    const tip = isWorking && state.phase !== "idle" ? (this.named.get("tool")?.position ?? null) : null;
    return { tip, next: tip && this.next(state.next, this.nextTouch) };
  }

  /** The vertices of the skin, in `head`, m. */
  get skinVertices(): BufferAttribute | null {
    return (this.skinMesh?.geometry.getAttribute("position") as BufferAttribute | undefined) ?? null;
  }

  /** Paint the skin, each vertex by a share of 0 to 1; null takes the paint away. */
  paintSkin(shares: Float32Array | null): void {
    const { skin, skinMesh } = this;
    if (skinMesh === null) return;
    this.backgroundChanges++;
    if (skin.vertexColors !== (shares !== null)) {
      skin.vertexColors = shares !== null;
      skin.color.copy(shares === null ? this.skinColor : WHITE);
      skin.needsUpdate = true;
    }
    if (shares === null) return;
    const colors = new Float32Array(3 * shares.length);
    const color = new Color();
    shares.forEach((share, index) => {
      color.copy(this.skinColor).lerp(COLORS.covered, share).toArray(colors, 3 * index);
    });
    skinMesh.geometry.setAttribute("color", new BufferAttribute(colors, 3));
  }

  /** Color the tool's tip and the fiducials. */
  mark(state: StateNews): void {
    this.tip.color.copy(tipColor(state.touch));
    if (state.next === this.markedNext && state.touched.length === this.markedTouches) return;
    this.markedNext = state.next;
    this.markedTouches = state.touched.length;
    this.pulses = state.next !== null;
    for (const [label, mesh] of this.fiducials) {
      const isTouched = state.touched.includes(label);
      mesh.material = isTouched ? this.touched : label === state.next ? this.nextMark : this.waiting;
    }
  }

  /** Show what the tool is in a procedure, how far it is fed, and its no-go structures. */
  showInstrument(procedure: ProcedureNews | null): void {
    const shown: readonly string[] = procedure === null ? [] : TOOL_NODES[procedure.tool];
    const fed = procedure === null ? 0 : procedure.feedMm / 1000;
    for (const name of AT_THE_TOOL) {
      const node = this.named.get(name);
      if (node === undefined) continue;
      const isFed = (INSTRUMENTS as readonly string[]).includes(name);
      node.visible = shown.includes(name) && (!isFed || fed > 0);
      if (isFed) node.scale.z = Math.max(fed, 1e-6);
    }
    const names = procedure === null ? [] : (this.news.noGo[procedure.name] ?? []);
    for (const node of this.noGo) {
      const name = (node.userData.name as string) ?? node.name;
      node.visible = shown.length > 0 && names.includes(name);
    }
  }

  /** Draw these bodies of the arm translucent, and the others not. */
  seeThrough(bodies: readonly string[]): void {
    for (const [name, meshes] of this.arm) {
      const isTranslucent = bodies.includes(name);
      for (const [mesh, own] of meshes) mesh.material = isTranslucent ? this.seenThrough : own;
    }
  }

  /** Show or hide the parts within the head, through the skin. */
  clearHead(isClear: boolean): void {
    if (this.skin.transparent === isClear) return;
    this.skin.transparent = isClear;
    this.skin.opacity = isClear ? CLEAR_SKIN_OPACITY : 1;
    this.skin.depthWrite = !isClear;
    this.skin.needsUpdate = true;
    // Only parts drawn before the skin show through it.
    for (const mesh of this.inHead) mesh.layers.set(isClear ? 0 : STATIC);
    this.backgroundChanges++;
  }

  /** Inputs of the kept background's picture. */
  get backgroundContent(): string {
    const head = this.named.get("head");
    return [this.root.id, this.backgroundChanges, ...(head?.position ?? []), ...(head?.quaternion ?? [])].join();
  }

  /** Brighten and darken the next fiducial; return whether it changes the picture at `now` (s). */
  pulse(now: number): boolean {
    const share = 0.5 - 0.5 * Math.cos((2 * Math.PI * now) / PULSE_S);
    this.nextMark.color.copy(COLORS.next).lerp(PULSE, share);
    return this.pulses;
  }

  dispose(): void {
    this.root.removeFromParent();
    this.root.traverse((node) => {
      if (node instanceof Mesh) {
        node.geometry.dispose();
        (node.material as MeshBasicMaterial).dispose();
      }
    });
  }

  private prepare(bodies: readonly string[]): void {
    const none = new Set<Object3D>();
    for (const name of FURNITURE) for (const mesh of this.batchNode(name, "matt", none)) mesh.layers.set(STATIC);
    const tip = this.named.get("tip_marker");
    const apart = [tip, ...AT_THE_TOOL.map((name) => this.named.get(name))];
    const kept = new Set(apart.filter((node) => node !== undefined));
    for (const name of bodies) {
      if (name === "head" || name === "plan") continue;
      const meshes = this.batchNode(name, "glossy", kept);
      this.arm.set(name, meshes.map((mesh) => [mesh, mesh.material] as const));
    }
    this.noGo.push(...(this.named.get("plan")?.children ?? []));
    this.showInstrument(null);
    if (tip instanceof Mesh) tip.material = this.tip;
    this.prepareHead();
  }

  private prepareHead(): void {
    const head = this.named.get("head");
    const skin = this.named.get("skin");
    if (head === undefined) return;
    const marks = new Group();
    for (const node of [...head.children]) {
      const name = (node.userData.name as string) ?? node.name;
      if (name.startsWith(FIDUCIAL) && node instanceof Mesh) {
        node.material = this.waiting;
        this.fiducials.set(name.slice(FIDUCIAL.length), node);
      } else if (node !== skin) {
        marks.add(node);
      }
    }
    head.add(marks);
    this.inHead.push(...batch(marks, "matt", new Set()));
    if (skin instanceof Mesh) {
      this.skinColor.copy(ownColor(skin).color);
      this.skin.color.copy(this.skinColor);
      this.skinMesh = skin;
      skin.material = this.skin;
      this.inHead.push(skin);
    }
    for (const mesh of this.inHead) mesh.layers.set(STATIC);
  }

  private batchNode(name: string, finish: Finish, apart: Set<Object3D>): Mesh[] {
    const node = this.named.get(name);
    return node === undefined ? [] : batch(node, finish, apart);
  }
}

function tipColor(stage: TouchStage): Color {
  if (isTouchError(stage)) return COLORS.error;
  return stage === "on skin" ? COLORS.onSkin : stage === "far" ? COLORS.free : COLORS.near;
}

/** Load the scene of `news`; `onProgress` receives the number of bytes loaded, and their total. */
export async function loadScene(
  news: SceneNews,
  bodies: readonly string[],
  onProgress: (loaded: number, total: number) => void,
): Promise<SceneModel> {
  const file = await new GLTFLoader().loadAsync(served(news.url), ({ loaded, total }) => onProgress(loaded, total));
  return new SceneModel(file.scene, news, bodies);
}

function glow(color: Color): MeshBasicMaterial {
  return new MeshBasicMaterial({ color: color.clone(), toneMapped: false });
}
