/** What the simulator and a view say to each other; docs/views.md explains each message. */

export const SUBPROTOCOL = "rastrainer.views.1";

export type Tone = "plain" | "good" | "warning" | "error";

export interface Item {
  readonly name: string;
  readonly label: string;
  readonly kind: "button" | "choice" | "text" | "axis";
  readonly value: string;
  readonly is_enabled: boolean;
  readonly help: string;
  /** Path of a picture that is shown while the item has the focus; "" for none. */
  readonly picture: string;
}

export interface Fact {
  readonly label: string;
  readonly value: string;
  readonly tone: Tone;
}

/** Scores of 0 to 100, oldest first; `mark` is the one that passes, 0 for none. */
export interface ScoreTrend {
  readonly text: string;
  readonly scores: readonly number[];
  readonly mark: number;
}

export interface Menu {
  readonly name: string;
  readonly title: string;
  readonly paragraphs: readonly string[];
  readonly facts: readonly Fact[];
  readonly items: readonly Item[];
  readonly focus: string;
  readonly picture: "" | "gamepad" | "keyboard" | "controllers";
  readonly trend: ScoreTrend | null;
}

export interface Message {
  readonly text: string;
  readonly tone: Tone;
}

export interface Hint {
  readonly control: string;
  readonly action: string;
  /** Name of the item that a click chooses; "" for none. */
  readonly item: string;
}

/** From a fiducial toward its touch, or a line of a procedure, in World, m; equal ends are a ball. */
export interface ErrorArrow {
  readonly begin: readonly [number, number, number];
  readonly end: readonly [number, number, number];
  readonly tone: Tone;
  /** Written above the ball; "" for nothing. */
  readonly name: string;
}

/** Distances from the tip of the locked guide along its axis, mm, as planned. */
export interface DepthRuler {
  readonly entry: number;
  readonly outer: number | null;
  readonly inner: number | null;
  readonly target: number;
  /** Of these four in this order, written beside the scale. */
  readonly names: readonly [string, string, string, string];
}

export interface Screen {
  readonly menu: Menu | null;
  readonly instruction: Message;
  readonly warnings: readonly Message[];
  readonly status: readonly string[];
  readonly hints: readonly Hint[];
  readonly language: string;
  /** Whether it is read aloud. */
  readonly is_spoken: boolean;
  /** Whether two sticks are drawn for a mouse, in the view that has control. */
  readonly has_sticks: boolean;
  readonly is_stepped: boolean;
  readonly has_arrow: boolean;
  readonly errors: readonly ErrorArrow[];
  /** Whether what is within the head is seen through the skin. */
  readonly is_head_clear: boolean;
  /** What the paint on the skin says while it is traced; "" where none is painted. */
  readonly coverage: string;
  readonly ruler: DepthRuler | null;
}

export type Triple = readonly [number, number, number];

/** x, y, z (m) and the unit quaternion qx, qy, qz, qw, in World. */
export type Pose = readonly [number, number, number, number, number, number, number];

/** Where somebody in a headset has eyes and controllers; both look along −z. */
export interface Wearer {
  readonly eyes: Pose;
  readonly left: Pose | null;
  readonly right: Pose | null;
}

export interface CameraPlace {
  readonly position: Triple;
  readonly focalPoint: Triple;
  readonly viewUp: Triple;
  readonly viewAngleDeg: number;
}

export interface Welcome {
  readonly type: "welcome";
  readonly protocol: number;
  readonly view: number;
  readonly bodies: readonly string[];
}

export interface SceneNews {
  readonly type: "scene";
  readonly url: string;
  readonly task: string;
  /** Whose right, forward and up the sticks follow. */
  readonly sticks: "camera" | "robot";
  readonly cameras: Readonly<Record<string, CameraPlace>>;
  readonly fiducials: Readonly<Record<string, Triple>>;
  /** Nodes of the no-go structures of each procedure. */
  readonly noGo: Readonly<Record<string, readonly string[]>>;
}

/** How the planned line lies to the guide, seen along its axis: right and up, mm. */
export interface Aim {
  readonly entryMm: readonly [number, number];
  readonly targetMm: readonly [number, number];
  readonly entryDistanceMm: number;
  readonly angleDeg: number;
}

/** What moves in the phases of a procedure. */
export interface ProcedureNews {
  readonly name: string;
  readonly tool: "pointer" | "guide" | "drill" | "electrode";
  readonly feedMm: number;
  readonly aim: Aim | null;
}

/** How the next touch is going; views show the last four in red. */
export type TouchStage = "far" | "near" | "on skin" | "pressed" | "too deep" | "elsewhere" | "shaft" | "arm";

/** Whether a touch goes wrong. */
export function isTouchError(stage: TouchStage): boolean {
  return !["far", "near", "on skin", "pressed"].includes(stage);
}

export interface StateNews {
  readonly type: "state";
  readonly tick: number;
  readonly time: number;
  readonly poses: readonly (readonly number[])[];
  /** Poses by body of an earlier trial that moves beside the arm; null without one. */
  readonly ghost: Readonly<Record<string, readonly number[]>> | null;
  readonly clearanceMm: number;
  readonly touch: TouchStage;
  readonly camera: string;
  /** Where the main picture is looked from: the camera of that name, as it is turned now. */
  readonly view: CameraPlace;
  /** Where the corner's picture looks along the skin, or across the line of a procedure; null without either. */
  readonly inset: CameraPlace | null;
  /** Bodies of the arm that cover tip or next point in each picture: they are seen through. */
  readonly translucent: Readonly<Record<"view" | "inset" | "worn", readonly string[]>>;
  readonly phase: string;
  readonly next: string | null;
  readonly touched: readonly string[];
  readonly elapsed: number;
  readonly procedure: ProcedureNews | null;
  /** For spectators only: who wears a headset, null for nobody. */
  readonly wearer?: Wearer | null;
}

/** Whether a procedure is at one of its lines: the guide is aligned, or something is fed through it. */
export function hasGuide({ procedure }: StateNews): boolean {
  return procedure !== null && procedure.tool !== "pointer";
}

export interface ScreenNews {
  readonly type: "screen";
  readonly screen: Screen;
}

export interface EventNews {
  readonly type: "event";
  readonly number: number;
  readonly kind: string;
  readonly sound: string;
  readonly volume: number;
  readonly rumble: number;
  readonly data: { readonly rumbleMs?: number };
}

export interface ControlNews {
  readonly type: "control";
  readonly holder: string;
  readonly isYou: boolean;
}

/** How another view is paired; sent only to views on the simulator's own computer. */
export interface PairingNews {
  readonly type: "pairing";
  readonly code: string;
  readonly addresses: readonly string[];
}

/** What is new of a trace over the skin: points in `head`, mm, after the first `known` ones. */
export interface TraceUpdate {
  readonly type: "trace";
  readonly known: number;
  readonly points: readonly Triple[];
  /** So far around the points the skin is painted; 0 where it is not. */
  readonly coveredMm: number;
  /** Where the next points would help most, and the outward normal there; in `head`. */
  readonly next: { readonly positionMm: Triple; readonly normal: Triple } | null;
}

export type News = TraceUpdate | Welcome | SceneNews | StateNews | ScreenNews | EventNews | ControlNews | PairingNews;

/** What a browser was paired for: to take part, or only to watch. */
export type Role = "view" | "spectator";

/** What a view says about itself when it connects. */
export interface Hello {
  readonly kind: "desktop" | "page" | "headset" | "spectator";
  readonly device: string;
  readonly refreshHz: number;
}
