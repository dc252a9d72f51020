/** The headset's controllers or tracked hands: input, rays and haptic pulses. */

import {
  BufferGeometry, Float32BufferAttribute, Line, LineBasicMaterial, Raycaster, type Intersection, type Object3D,
  type WebXRManager, type XRTargetRaySpace,
} from "three";

import type { Connection } from "../stream/connection";
import type { Feedback } from "../generated";
import type { ElementPanel } from "../panels/element_panel";
import type { RoomPanels } from "./room_panels";
import { controllerBody } from "../scene/headset_view";
import type { Grab } from "./grab";

const DEAD = 0.12;
const CHANGE = 0.01;
const YAW_CHANGE_DEG = 1;
/** Order of drawing. */
const AFTER_BOARDS = 20;
const PRESSED = 0.6;
const RELEASED = 0.4;
const REPEAT_AFTER_S = 0.4;
const REPEAT_EVERY_S = 0.15;
/** A picture that took longer was late: nobody held the stick for a second step. */
const LONGEST_STEP_S = 0.1;
/** Indices of buttons and axes in the mapping "xr-standard". */
const TRIGGER = 0;
const SQUEEZE = 1;
const TOUCHPAD = 2;
const THUMBSTICK = 3;
const NEAR_BUTTON = 4;
const FAR_BUTTON = 5;
/** A wand without these two has its touchpad or stick pressed: at its upper end for the far one. */
const UPPER_END = -0.5;

interface Hand {
  readonly ray: XRTargetRaySpace;
  readonly line: Line;
  source: XRInputSource | null;
  readonly down: boolean[];
  pointed: string;
  /** Whether thumb and finger of a tracked hand are together, and whether they have just met. */
  isPinched: boolean;
  hasMet: boolean;
}

export class Hands {
  private readonly hands: readonly Hand[];
  private readonly raycaster = new Raycaster();
  private readonly hits: Intersection[] = [];
  private readonly message = {
    type: "sticks" as const,
    translation: [0, 0, 0] as [number, number, number],
    rotation: [0, 0] as [number, number],
    fine: false,
    yawDeg: 0,
  };
  /** The input sent last: translation, rotation, and whether it is fine. */
  private sent = [0, 0, 0, 0, 0, 0];
  private repeated = "";
  private repeatIn = 0;
  isHolding = false;
  /** Where the eyes look, counterclockwise from World's x: the sticks' forward is there. */
  yawDeg = 0;
  /** Whether sticks step, as through a menu. */
  sticksNavigate = false;
  /** Whether a guide is aligned: with its trigger held, the right stick turns and tilts it. */
  isAligning = false;

  constructor(
    xr: WebXRManager,
    parent: Object3D,
    private readonly panels: RoomPanels,
    private readonly connection: Connection,
    private readonly grab: Grab,
    /** Is called with the name of a part of a panel that was chosen by pointing at it. */
    private readonly onChosen: (name: string) => void,
  ) {
    this.hands = [0, 1].map((index) => makeHand(xr.getController(index), parent));
  }

  /** Look at the controllers `passed` seconds after the last look. */
  poll(passed: number): void {
    this.message.translation.fill(0);
    this.message.rotation.fill(0);
    this.message.fine = false;
    let hovered = "";
    let step = "";
    for (const hand of this.hands) {
      hand.pointed = this.point(hand);
      if (hand.pointed !== "") hovered = hand.pointed;
      // A hand out of sight, or a controller put away, holds nothing.
      if (hand.source === null || !hand.ray.visible) this.grab.end(hand.ray);
      if (hand.source?.hand) {
        this.takePinch(hand);
        continue;
      }
      const pad = hand.source?.gamepad;
      if (!pad) continue;
      this.takeButtons(hand, pad);
      this.takeSticks(hand, pad);
      step = step || stepOf(pad);
    }
    this.panels.hover(hovered);
    this.grab.steer(this.message.translation, passed);
    this.tellSticks();
    this.repeat(this.sticksNavigate ? step : "", Math.min(LONGEST_STEP_S, passed));
  }

  /** Return the controller of that hand, null where there is none. */
  controller(handedness: XRHandedness): XRTargetRaySpace | null {
    return this.hands.find(({ source, ray }) => source?.handedness === handedness && ray.visible)?.ray ?? null;
  }

  /** Let both hands feel something. */
  feel(event: Feedback): void {
    if (event.rumble <= 0) return;
    for (const hand of this.hands) {
      const pad = hand.source?.gamepad as PulsingPad | undefined;
      void pad?.hapticActuators?.[0]?.pulse(event.rumble, event.rumbleMs);
    }
  }

  release(): void {
    this.isHolding = false;
    this.sent.fill(0);
    for (const hand of this.hands) hand.down.fill(false);
  }

  private point(hand: Hand): string {
    hand.line.visible = false;
    if (hand.source === null || hand.source.targetRayMode !== "tracked-pointer") return "";
    // As it is now, not as it was drawn last.
    hand.ray.updateWorldMatrix(true, false);
    this.raycaster.setFromXRController(hand.ray);
    this.hits.length = 0;
    const panels = hand.source.hand ? this.panels.touchable : this.panels.pointable;
    for (const panel of panels) {
      if (panel.mesh.visible) this.raycaster.intersectObject(panel.mesh, false, this.hits);
    }
    const hit = this.hits[0];
    if (hit?.uv === undefined) return "";
    hand.line.visible = true;
    hand.line.scale.z = hit.distance;
    return (hit.object.userData.panel as ElementPanel).at(hit.uv);
  }

  /** Choose what a tracked hand points at, or have the tip follow the hand while it pinches. */
  private takePinch(hand: Hand): void {
    if (hand.hasMet && hand.pointed !== "") this.onChosen(hand.pointed);
    else if (hand.hasMet) this.grab.begin(hand.ray);
    hand.hasMet = false;
    if (!hand.isPinched) this.grab.end(hand.ray);
  }

  private takeSticks(hand: Hand, pad: Gamepad): void {
    const [across, down] = stickOf(pad);
    // Where a touchpad is pressed to touch, the finger must not move the tip.
    const isClicked = isWand(pad) && (hand.down[NEAR_BUTTON]! || hand.down[FAR_BUTTON]!);
    const x = isClicked ? 0 : alive(across);
    const y = isClicked ? 0 : -alive(down);
    const isTriggered = hand.pointed === "" && (pad.buttons[TRIGGER]?.value ?? 0) > PRESSED;
    const { translation, rotation } = this.message;
    if (hand.source?.handedness === "left") {
      translation[0] = x;
      translation[1] = y;
    } else {
      rotation[0] = x;
      if (this.isAligning && isTriggered) rotation[1] = y;
      else translation[2] = y;
    }
    if (isTriggered) this.message.fine = true;
  }

  private takeButtons(hand: Hand, pad: Gamepad): void {
    const isLeft = hand.source?.handedness === "left";
    if (this.pressed(hand, pad, TRIGGER) && hand.pointed !== "") this.onChosen(hand.pointed);
    if (this.pressed(hand, pad, NEAR_BUTTON)) this.press(isLeft ? "menu" : "touch");
    if (this.pressed(hand, pad, FAR_BUTTON)) this.press(isLeft ? "camera" : "undo");
    if (this.pressed(hand, pad, SQUEEZE)) this.grab.begin(hand.ray);
    if (!hand.down[SQUEEZE]) this.grab.end(hand.ray);
  }

  /** Return whether a button has just been pressed. */
  private pressed(hand: Hand, pad: Gamepad, index: number): boolean {
    const value = valueOf(pad, index);
    const was = hand.down[index]!;
    hand.down[index] = was ? value > RELEASED : value > PRESSED;
    return hand.down[index]! && !was;
  }

  private press(control: string): void {
    this.connection.send({ type: "press", control });
  }

  private tellSticks(): void {
    const { translation, rotation, fine, yawDeg } = this.message;
    const pushes = [...translation, ...rotation, Number(fine)];
    this.isHolding = pushes.some((value) => value !== 0);
    const differs = pushes.some((value, index) => {
      const before = this.sent[index]!;
      return Math.abs(value - before) > CHANGE || (value === 0 && before !== 0);
    });
    const hasTurned = this.isHolding && Math.abs(this.yawDeg - yawDeg) > YAW_CHANGE_DEG;
    if (!differs && !hasTurned) return;
    this.message.yawDeg = this.yawDeg;
    this.sent = pushes;
    this.connection.send(this.message);
  }

  private repeat(step: string, passed: number): void {
    if (step === "") {
      this.repeated = "";
      return;
    }
    this.repeatIn -= passed;
    const isNew = step !== this.repeated;
    if (!isNew && this.repeatIn > 0) return;
    this.repeatIn = isNew ? REPEAT_AFTER_S : REPEAT_EVERY_S;
    this.repeated = step;
    this.press(step);
  }
}

/** The older name of what three's types know as `vibrationActuator`; headsets have only this. */
interface PulsingPad {
  readonly hapticActuators?: readonly { pulse(value: number, duration: number): Promise<boolean> }[];
}

function makeHand(ray: XRTargetRaySpace, parent: Object3D): Hand {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute([0, 0, 0, 0, 0, -1], 3));
  const line = new Line(geometry, new LineBasicMaterial({ color: 0xbfdbff, depthTest: false, transparent: true }));
  line.renderOrder = AFTER_BOARDS;
  ray.add(line, controllerBody());
  parent.add(ray);
  const down = new Array<boolean>(8).fill(false);
  const hand: Hand = { ray, line, source: null, down, pointed: "", isPinched: false, hasMet: false };
  ray.addEventListener("connected", (event) => (hand.source = event.data));
  ray.addEventListener("disconnected", () => {
    hand.source = null;
    hand.isPinched = false;
  });
  ray.addEventListener("selectstart", () => (hand.isPinched = hand.hasMet = true));
  ray.addEventListener("selectend", () => (hand.isPinched = false));
  return hand;
}

function alive(position: number): number {
  const size = Math.abs(position);
  return size < DEAD ? 0 : Math.sign(position) * Math.min(1, (size - DEAD) / (1 - DEAD));
}

function isWand(pad: Gamepad): boolean {
  return pad.buttons.length <= NEAR_BUTTON;
}

/** Return how far a button is pressed, 0 to 1; on a wand also for a button that it lacks. */
function valueOf(pad: Gamepad, index: number): number {
  if (!isWand(pad) || index < NEAR_BUTTON) return pad.buttons[index]?.value ?? 0;
  const isFar = stickOf(pad)[1] < UPPER_END;
  if (isFar !== (index === FAR_BUTTON)) return 0;
  return Math.max(pad.buttons[TOUCHPAD]?.value ?? 0, pad.buttons[THUMBSTICK]?.value ?? 0);
}

/** Return where the stick is, or the finger on the touchpad of a wand without one: right, down. */
function stickOf(pad: Gamepad): readonly [number, number] {
  const first = pad.axes.length > 2 ? 2 : 0;
  return [pad.axes[first] ?? 0, pad.axes[first + 1] ?? 0];
}

function stepOf(pad: Gamepad): string {
  const [x, y] = stickOf(pad);
  if (Math.max(Math.abs(x), Math.abs(y)) < PRESSED) return "";
  if (Math.abs(y) >= Math.abs(x)) return y > 0 ? "down" : "up";
  return x > 0 ? "right" : "left";
}

