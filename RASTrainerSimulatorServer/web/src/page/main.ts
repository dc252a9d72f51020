/** The page: connects to the simulator, shows its screens, and sends the user's input. */

import { Connection, readRole } from "../stream/connection";
import { byId } from "../elements";
import { EnterButton } from "../overlay/enter_button";
import { ErrorArrows } from "../scene/error_arrows";
import { FlatView } from "../scene/flat_view";
import { FrameCount } from "../stream/frame_count";
import { Ghost } from "../scene/ghost";
import { Gamepads } from "../input/gamepads";
import { Keyboard } from "../input/keyboard";
import {
  BANNERS, TONES, type ControlNews, type Feedback, type Hello, type News, type SceneNews, type Screen, type StateNews,
} from "../generated";
import { isSoftware } from "../scene/graphics";
import { hasGuide, isTouchError } from "../stream/stages";
import { Loading } from "../overlay/loading";
import { Overlay } from "../overlay/overlay";
import { pair } from "../stream/pairing";
import { PictureReport } from "../stream/picture_report";
import { PoseStream } from "../scene/pose_stream";
import { loadScene, type SceneModel } from "../scene/scene_model";
import { Sounds } from "../audio/sounds";
import { Speech } from "../audio/speech";
import { isPairedAgain, onlyRead, showWatching, SPECTATOR } from "../overlay/spectator";
import { Stage } from "../scene/stage";
import { clearSight } from "../overlay/clear_sight";
import { SightArrows } from "../overlay/sight_arrows";
import { say, useLanguage } from "../texts";
import { TouchControls } from "../input/touch_controls";
import { TouchRing } from "../scene/touch_ring";
import { TraceMarks } from "../scene/trace_marks";
import { ViewMouse } from "../input/view_mouse";
import { HeadsetView } from "../scene/headset_view";
import { GuidingPanel } from "../panels/guiding_panel";
import { Headset } from "../xr/headset";

/** Where the processor draws, it has other work, too: no more than 30 pictures a second. */
const LEAST_PAUSE_S = 0.9 / 30;

export class Page {
  private readonly connection = new Connection(PAGE, {
    onNews: (news) => this.take(news),
    onConnected: (isConnected) => this.connected(isConnected),
    onUnknown: () => void this.begin(true),
  });
  /** Null where the browser cannot draw: menus and results are read all the same. */
  private readonly stage = Stage.on(byId("picture") as HTMLCanvasElement);
  private readonly flat = this.stage && new FlatView(this.stage, byId("inset"));
  private readonly overlay = new Overlay(this.connection);
  private readonly speech = new Speech();
  private readonly keyboard = new Keyboard(this.connection);
  private readonly mouse = new ViewMouse(byId("picture"), this.connection);
  private readonly pads = new Gamepads(this.connection, () => this.sayNotice());
  private readonly touch = new TouchControls(this.connection);
  private readonly sounds = new Sounds();
  private readonly frames = new FrameCount(this.connection);
  private readonly picture = new PictureReport(this.connection);
  private readonly arrows = new SightArrows();
  private readonly ring = this.stage && new TouchRing(this.stage.scene);
  private readonly headsetView = this.stage && new HeadsetView(this.stage.world);
  private readonly errors = new ErrorArrows();
  private readonly trace = new TraceMarks();
  private readonly ghost = new Ghost();
  private readonly guiding = new GuidingPanel(byId("guiding") as HTMLCanvasElement);
  private readonly loading = new Loading();
  private readonly enter = new EnterButton((session) => void this.enterHeadset(session));
  private headset: Headset | null = null;
  private screen: Screen | null = null;
  private control: ControlNews | null = null;
  private bodies: readonly string[] = [];
  private poses = new PoseStream(0);
  private state: StateNews | null = null;
  private lastEvent = 0;
  private scene: SceneNews | null = null;
  private isDue = true;
  private lastPicture = -Infinity;

  constructor() {
    this.connection.isHolding = () =>
      this.keyboard.isHolding || this.pads.isHolding || this.touch.isHolding || (this.headset?.isHolding ?? false);
    document.addEventListener("visibilitychange", () => {
      const isSeen = this.headset !== null || !document.hidden;
      if (!isSeen) {
        this.pads.release();
        this.touch.release();
      }
      this.connection.send({ type: "visibility", isVisible: isSeen });
    });
    this.label();
    const { stage } = this;
    if (stage === null) return;
    stage.setQuality(stage.affordable);
    stage.renderer.setAnimationLoop((now, frame) => this.turn(stage, now, frame));
  }

  /** Pair if need be, and connect. */
  async begin(wasPaired = false): Promise<void> {
    let role = isPairedAgain() ? null : await readRole();
    if (role === null) {
      await pair(byId("pairing") as HTMLFormElement, say, wasPaired ? say("restarted") : "", say("watch"));
      role = await readRole();
    }
    this.connection.start(role === "spectator" ? SPECTATOR : PAGE);
    this.label();
    await this.sounds.load();
  }

  private connected(isConnected: boolean): void {
    this.sayNotice();
    this.headset?.setNotice(isConnected ? "" : say("lost"));
    if (isConnected) void this.keyboard.tellNames();
    this.lastEvent = 0;
  }

  private sayNotice(): void {
    if (!this.connection.isConnected) this.overlay.setNotice("lost");
    else if (this.stage === null) this.overlay.setNotice("noPicture");
    else this.overlay.setNotice(this.pads.isUnknown ? "unknownPad" : "");
  }

  private take(news: News): void {
    switch (news.type) {
      case "welcome":
        this.bodies = news.bodies;
        this.poses = new PoseStream(news.bodies.length);
        this.trace.reset();
        if (this.stage !== null) this.picture.begin();
        this.isDue = true;
        break;
      case "trace":
        this.trace.take(news);
        break;
      case "scene":
        void this.load(news);
        break;
      case "state":
        this.takeState(news);
        break;
      case "screen":
        this.showScreen(this.connection.isWatching ? onlyRead(news.screen) : news.screen);
        break;
      case "control":
        this.control = news;
        this.pads.takeControl(news);
        this.touch.takeControl(news);
        this.overlay.showControl(news);
        this.headset?.showControl(news);
        break;
      case "pairing":
        this.overlay.showPairing(news);
        break;
      case "event":
        this.happen(news);
    }
  }

  private showScreen(screen: Screen): void {
    this.screen = screen;
    this.isDue = true;
    useLanguage(screen.language);
    this.label();
    this.overlay.show(screen);
    this.speech.show(screen);
    this.touch.show(screen);
    this.headset?.showScreen(screen);
  }

  /** Name in the present language what the page itself names. */
  private label(): void {
    byId("picture").setAttribute("aria-label", say("view"));
    byId("status").setAttribute("aria-label", say("status"));
    this.enter.label();
    this.overlay.label();
    showWatching(this.connection.isWatching);
  }

  private async load(news: SceneNews): Promise<void> {
    const isKnown = news.url === this.scene?.url;
    this.scene = news;
    const { stage } = this;
    if (stage === null) return;
    if (isKnown) {
      this.useScene(stage);
      return;
    }
    const isWanted = () => news.url === this.scene?.url;
    try {
      const model = await loadScene(news, this.bodies, (loaded, total) => {
        if (!isWanted()) return;
        this.loading.show(loaded, total);
        this.picture.loaded(news.task, loaded, total);
      });
      if (!isWanted()) return;
      this.loading.hide();
      stage.show(model);
      this.useScene(stage);
      document.body.dataset.scene = news.task || "none";
    } catch {
      this.loading.hide();
      if (this.scene === news) this.scene = null;
      this.overlay.setNotice("noScene");
    }
  }

  /** Take what goes with the file, such as the cameras: it may change while the file stays. */
  private useScene({ model }: Stage): void {
    if (model === null || this.scene === null || model.news.url !== this.scene.url) return;
    model.news = this.scene;
    this.flat?.take(this.scene);
    this.isDue = true;
  }

  private takeState(state: StateNews): void {
    const now = performance.now() / 1000;
    this.poses.put(state.timeS, state.poses, now);
    this.ghost.put(state.timeS, state.ghost, now);
    this.headsetView?.put(state.headset, now);
    this.state = state;
    this.touch.takeState(state);
    this.isDue = true;
  }

  private happen(event: Feedback): void {
    if (event.number <= this.lastEvent) return;
    this.lastEvent = event.number;
    this.sounds.play(event.sound, event.volume);
    this.pads.feel(event);
    this.headset?.feel(event);
  }

  private async enterHeadset(session: XRSession): Promise<void> {
    const { stage, connection, sounds, frames } = this;
    if (stage === null) return;
    sounds.unlock();
    stage.setQuality("low");
    const leave = () => void session.end();
    const headset = new Headset(stage, connection, sounds, frames, session, leave);
    session.addEventListener("end", () => this.leaveHeadset());
    this.headset = headset;
    if (this.screen !== null) headset.showScreen(this.screen);
    if (this.control !== null) headset.showControl(this.control);
    await headset.begin();
    this.enter.setInside(true);
    document.body.dataset.headset = "inside";
  }

  private leaveHeadset(): void {
    this.headset?.end();
    this.headset = null;
    this.stage?.setQuality(this.stage.affordable);
    this.frames.reset();
    this.connection.rejoin(PAGE);
    this.enter.setInside(false);
    this.isDue = true;
    delete document.body.dataset.headset;
  }

  private turn(stage: Stage, nowMs: number, frame?: XRFrame): void {
    const now = nowMs / 1000;
    if (!isDesktop) this.pads.poll();
    this.frames.asked(nowMs);
    this.frames.tell(nowMs);
    const { state, flat } = this;
    const { model } = stage;
    if (state === null || model === null || flat === null) return;
    if (this.errors.show(this.screen?.errors ?? [], model.root)) this.isDue = true;
    if (this.trace.show(model)) this.isDue = true;
    if (this.headset !== null) {
      if (frame === undefined) return;
      this.place(model);
      model.mark(state);
      this.showProcedure(model, state);
      model.pulse(now);
      this.ring?.show(model, state, stage.renderer.xr.getCamera(), this.screen?.menu == null);
      this.headset.draw(now, frame, model, state);
      this.frames.drawn();
      this.picture.drawn(model.news.task);
    } else {
      this.drawFlat(flat, now, model, state);
    }
  }

  private place(model: SceneModel): void {
    const now = performance.now() / 1000;
    this.poses.place(model.bodies, now);
    this.ghost.show(model, now);
  }

  /** Show the tool of a procedure, and where it stands. */
  private showProcedure(model: SceneModel, { procedure }: StateNews): void {
    model.showInstrument(procedure);
    model.clearHead(this.screen?.isHeadClear ?? false);
    const isWorking = this.screen?.menu == null;
    const aim = isWorking ? (procedure?.aim ?? null) : null;
    const ruler = isWorking ? (this.screen?.ruler ?? null) : null;
    const depth = procedure?.feedMm ?? 0;
    if (this.headset === null) this.guiding.show(aim, ruler, depth);
    else this.headset.showGuiding(aim, ruler, depth);
  }

  private drawFlat(flat: FlatView, now: number, model: SceneModel, state: StateNews): void {
    if (this.screen?.menu == null) this.mouse.tell();
    flat.choose(state, now, this.headsetView?.place(now) ?? null);
    const pause = now - this.lastPicture;
    if (isSoftware && pause >= 0 && pause < LEAST_PAUSE_S) return;
    const hasMoved = flat.advance(now) || this.isDue;
    if (!model.pulse(now) && !hasMoved) return;
    this.lastPicture = now;
    this.isDue = false;
    this.place(model);
    model.mark(state);
    this.showProcedure(model, state);
    const isWorking = this.screen?.menu == null;
    // After the score the title of a clear head, whose lines it explains, needs the place.
    const hasRoom = !this.screen?.isHeadClear || hasGuide(state);
    const inset = isWorking && hasRoom ? flat.insetName : "";
    this.overlay.showInset(inset);
    this.overlay.showError(isWorking && isTouchError(state.touch));
    this.ring?.show(model, state, flat.camera, isWorking);
    const { tip, next } = model.placesAtWork(state, isWorking);
    this.arrows.show(tip, this.screen?.hasArrow ? next : null, state.next, flat.camera);
    clearSight([tip, next].filter((place) => place !== null), flat.camera);
    this.isDue = flat.draw(inset !== "", now);
    this.frames.drawn();
    this.picture.drawn(model.news.task);
  }
}

/** Whether this is the window of the simulator's own computer, which reads the gamepads itself. */
const isDesktop = new URLSearchParams(location.search).has("desktop");
const PAGE: Hello = { type: "hello", kind: isDesktop ? "desktop" : "page", device: browserName(), refreshHz: 0 };

function browserName(): string {
  return /(Firefox|Edg|OPR|Chrome|Safari)\/\d+/.exec(navigator.userAgent)?.[0] ?? "";
}

for (const [prefix, colors] of [["--", TONES], ["--banner-", BANNERS]] as const) {
  for (const [tone, color] of Object.entries(colors)) document.documentElement.style.setProperty(prefix + tone, color);
}
const page = new Page();
/** For measurements from outside; the page itself makes no use of it. */
(window as unknown as { page: Page }).page = page;
void page.begin();
