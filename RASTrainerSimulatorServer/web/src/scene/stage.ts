/** Renderer, light and the scene that is shown. */

import {
  Color, DirectionalLight, HemisphereLight, NeutralToneMapping, Object3D, PCFShadowMap, PMREMGenerator, Scene,
  WebGLRenderer, Mesh,
} from "three";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";

import { STATIC } from "./background_cache";
import { isSoftware } from "./graphics";
import type { SceneModel } from "./scene_model";

const SKY = new Color(0xe6edf2);
/** Light of sky, ground and sun; where no environment lights, too, it is as bright without it. */
const LIGHT = isSoftware
  ? { sky: 3.4, ground: 0xb0b4b6, sun: 1.6 }
  : { sky: 1.3, ground: 0x8b8f90, sun: 2.0 };
const SHADOW_SIDE = 0.9;
const SHADOW_PIXELS = 1024;

export type Quality = "high" | "low";

export class Stage {
  readonly scene = new Scene();
  /** In World: x forward, y left, z up. */
  readonly world = new Object3D();
  model: SceneModel | null = null;
  private readonly sun = new DirectionalLight(0xfff6ea, LIGHT.sun);

  /** Return a stage that draws on a canvas; null where the browser has no WebGL. */
  static on(canvas: HTMLCanvasElement): Stage | null {
    try {
      return new Stage(new WebGLRenderer({ canvas, antialias: !isSoftware }));
    } catch {
      return null;
    }
  }

  private constructor(readonly renderer: WebGLRenderer) {
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.scene.background = SKY;
    this.world.rotation.x = -Math.PI / 2;
    this.scene.add(this.world);
    this.light();
  }

  /** Show another scene. */
  show(model: SceneModel): void {
    this.model?.dispose();
    this.model = model;
    this.scene.add(model.root);
    this.cast(this.renderer.shadowMap.enabled);
  }

  /** Quality that this machine can afford on a flat display. */
  get affordable(): Quality {
    return isSoftware ? "low" : "high";
  }

  /** Draw with shadows, or without. */
  setQuality(quality: Quality): void {
    const isHigh = quality === "high";
    this.renderer.shadowMap.enabled = isHigh;
    this.sun.castShadow = isHigh;
    this.cast(isHigh);
  }

  private cast(isCast: boolean): void {
    this.model?.root.traverse((node) => {
      if (node instanceof Mesh) node.castShadow = node.receiveShadow = isCast;
    });
  }

  private light(): void {
    if (!isSoftware) {
      const environment = new PMREMGenerator(this.renderer).fromScene(new RoomEnvironment(), 0.04);
      this.scene.environment = environment.texture;
      this.scene.environmentIntensity = 0.45;
    }
    const hemisphere = new HemisphereLight(0xf4f8ff, LIGHT.ground, LIGHT.sky);
    this.sun.position.set(-0.25 + 0.48, 1.6, 0.9);
    this.sun.target.position.set(0.48, 0.2, 0);
    const shadow = this.sun.shadow;
    shadow.mapSize.set(SHADOW_PIXELS, SHADOW_PIXELS);
    shadow.camera.left = shadow.camera.bottom = -SHADOW_SIDE;
    shadow.camera.right = shadow.camera.top = SHADOW_SIDE;
    shadow.camera.near = 0.1;
    shadow.camera.far = 4;
    shadow.bias = -0.0006;
    shadow.normalBias = 0.004;
    shadow.radius = 3;
    for (const light of [hemisphere, this.sun]) light.layers.enable(STATIC);
    this.scene.add(hemisphere, this.sun, this.sun.target);
  }
}
