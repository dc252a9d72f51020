/** The view in a headset, from entering immersive VR to leaving it. */

import { PerspectiveCamera, Vector3 } from "three";

import type { Connection } from "../stream/connection";
import type { FrameCount } from "../stream/frame_count";
import type { GuideAim, ControlNews, DepthRuler, Feedback, Hello, SceneNews, Screen, StateNews } from "../generated";
import type { SceneModel } from "../scene/scene_model";
import type { Sounds } from "../audio/sounds";
import { STATIC } from "../scene/background_cache";
import type { Stage } from "../scene/stage";
import { RoomPanels } from "./room_panels";
import { headsetModel } from "./device";
import { Grab } from "./grab";
import { Hands } from "./hands";
import { Placement } from "./placement";
import { type ArrowLook, SightArrow } from "./sight_arrow";
import { HeadsetPoses } from "./headset_poses";

const HIGHEST_HZ = 90;
const MAX_FOVEATION = 1;
/** Beyond this, the direction of the eyes gives no way ahead. */
const STEEP = 0.9;
/** In the colors that arrows at the page's edge have; that to the tool is slender, as the tool is. */
const TO_POINT: ArrowLook = { color: 0xffe14a, down: 0.16, radius: 0.007 };
const TO_TOOL: ArrowLook = { color: 0x8cc8ff, down: 0.22, radius: 0.003 };

export class Headset {
  private readonly camera = new PerspectiveCamera(70, 1, 0.05, 20);
  private readonly placement = new Placement();
  private readonly panels: RoomPanels;
  private readonly grab = new Grab();
  private readonly arrow = new SightArrow(TO_POINT);
  private readonly toolArrow = new SightArrow(TO_TOOL);
  private hasArrow = false;
  private isWorking = false;
  private readonly hands: Hands;
  private readonly poses: HeadsetPoses;
  private base: XRReferenceSpace | null = null;
  private mustRecenter = false;
  private looked = 0;
  private shownNews: SceneNews | null = null;
  /** The middle of both eyes: place, line of sight, up, and level ahead. */
  private readonly eyes = { place: new Vector3(), gaze: new Vector3(), up: new Vector3(), ahead: new Vector3() };
  private readonly tip = new Vector3();

  constructor(
    private readonly stage: Stage,
    private readonly connection: Connection,
    private readonly sounds: Sounds,
    private readonly frames: FrameCount,
    private readonly session: XRSession,
    private readonly leave: () => void,
  ) {
    const { scene, renderer } = stage;
    this.panels = new RoomPanels(connection);
    this.poses = new HeadsetPoses(connection, stage.world);
    this.camera.layers.enable(STATIC);
    this.placement.rig.add(this.camera);
    scene.add(this.placement.rig, this.panels.room);
    this.panels.room.add(this.arrow.group, this.toolArrow.group);
    this.hands = new Hands(renderer.xr, this.placement.rig, this.panels, connection, this.grab, (name) => this.choose(name));
  }

  /** Take over the picture. */
  async begin(): Promise<void> {
    const { xr } = this.stage.renderer;
    xr.enabled = true;
    xr.setReferenceSpaceType("local-floor");
    xr.setFoveation(MAX_FOVEATION);
    await xr.setSession(this.session);
    xr.setFoveation(MAX_FOVEATION);
    this.base = xr.getReferenceSpace();
    this.base?.addEventListener("reset", () => (this.mustRecenter = true));
    this.mustRecenter = true;
    await this.setFrameRate();
    this.session.addEventListener("visibilitychange", () => {
      const isVisible = this.session.visibilityState === "visible";
      if (!isVisible) {
        this.hands.release();
        if (this.session.visibilityState === "hidden") this.poses.sendDoffed();
      }
      this.connection.send({ type: "visibility", isVisible });
    });
    this.sounds.setSpatial(true);
    this.connection.rejoin(this.hello());
  }

  /** Leave the picture to the flat view. */
  end(): void {
    this.panels.dispose();
    this.arrow.dispose();
    this.toolArrow.dispose();
    this.hands.release();
    this.placement.rig.removeFromParent();
    this.stage.renderer.xr.enabled = false;
    this.sounds.setSpatial(false);
  }

  get isHolding(): boolean {
    return this.hands.isHolding;
  }

  showScreen(screen: Screen): void {
    this.isWorking = screen.menu === null;
    this.hasArrow = this.isWorking && screen.hasArrow;
    this.panels.show(screen);
    this.hands.sticksNavigate = this.panels.sticksNavigate;
  }

  showControl(control: ControlNews): void {
    this.panels.showControl(control);
  }

  showGuiding(aim: GuideAim | null, ruler: DepthRuler | null, depth: number): void {
    this.panels.showGuiding(aim, ruler, depth);
    this.hands.isAligning = aim !== null;
  }

  setNotice(text: string): void {
    this.panels.setNotice(text);
  }

  feel(event: Feedback): void {
    this.hands.feel(event);
  }

  /** Take a scene that is new to it. */
  takeScene(model: SceneModel): void {
    const camera = model.news.cameras["close-up"] ?? Object.values(model.news.cameras)[0];
    if (camera === undefined) return;
    this.placement.take(camera);
    this.seat();
    this.grab.take(model.node("tool"));
  }

  /** Draw for both eyes, `now` in s. */
  draw(now: number, frame: XRFrame, model: SceneModel, state: StateNews): void {
    if (model.news !== this.shownNews) {
      this.shownNews = model.news;
      this.takeScene(model);
    }
    this.recenter(frame);
    this.lookAround(model);
    this.hands.poll(Math.min(1, now - this.looked));
    this.looked = now;
    // A device may go on asking for pictures of a headset that was taken off.
    if (this.session.visibilityState !== "hidden") {
      this.poses.send(now, this.camera, this.hands.controller("left"), this.hands.controller("right"));
    }
    this.panels.closeUp.draw(this.stage, this.panels.room, state);
    const { tip, next } = model.placesAtWork(state, this.isWorking);
    this.arrow.show(this.hasArrow ? next : null, this.camera);
    this.toolArrow.show(tip, this.camera);
    model.seeThrough(state.translucent.headset);
    this.stage.renderer.render(this.stage.scene, this.camera);
  }

  private recenter(frame: XRFrame): void {
    if (!this.mustRecenter || this.base === null) return;
    const pose = frame.getViewerPose(this.base);
    if (!pose) return;
    this.mustRecenter = false;
    this.placement.recenter(pose);
    this.seat();
  }

  /** Place the panels for a person who is where they belong. */
  private seat(): void {
    const { eyes, forward, focus } = this.placement;
    this.panels.put(eyes, forward, focus);
  }

  /** Have sticks, grab, panels and sounds follow the eyes. */
  private lookAround(model: SceneModel): void {
    const { camera, tip } = this;
    const { place, gaze, up, ahead } = this.eyes;
    camera.updateWorldMatrix(true, false);
    camera.getWorldPosition(place);
    camera.getWorldDirection(gaze);
    up.setFromMatrixColumn(camera.matrixWorld, 1);
    // For eyes that look down or up, ahead is at the top or the bottom of the picture.
    if (Math.abs(gaze.y) > STEEP) ahead.copy(up).multiplyScalar(-Math.sign(gaze.y));
    else ahead.copy(gaze);
    ahead.setY(0).normalize();
    this.hands.yawDeg = (Math.atan2(-ahead.z, ahead.x) * 180) / Math.PI;
    if (model.news.sticks === "camera") this.grab.turn(ahead);
    this.panels.follow(place, ahead);
    model.node("tool")?.getWorldPosition(tip);
    this.sounds.locate(place, gaze, up, tip);
  }

  private choose(name: string): void {
    if (this.panels.scroll(name)) return;
    switch (this.panels.localAction(name)) {
      case "recenter":
        this.mustRecenter = true;
        break;
      case "higher":
      case "lower":
        this.placement.raise(name.endsWith("higher") ? 1 : -1);
        this.seat();
        break;
      case "grab":
        this.grab.isAllowed = !this.grab.isAllowed;
        this.panels.setGrab(this.grab.isAllowed);
        break;
      case "leave":
        this.leave();
        break;
      default:
        this.connection.send({ type: "item", name });
    }
  }

  private async setFrameRate(): Promise<void> {
    const rates = [...(this.session.supportedFrameRates ?? [])].filter((hz) => hz <= HIGHEST_HZ);
    const wanted = Math.max(0, ...rates);
    if (wanted > 0) await this.session.updateTargetFrameRate(wanted).catch(() => undefined);
    this.frames.reset(this.session.frameRate ?? wanted);
  }

  private hello(): Hello {
    const device = headsetModel(this.session, navigator.userAgent);
    return { type: "hello", kind: "headset", device, refreshHz: this.frames.fixedHz };
  }
}
