/**
 * What page and simulator share, written by tools/page_types.py: do not edit.
 * docs/views.md explains the messages, presentation/look.py the constants.
 */

/** The first message: the number of the view, and the bodies in the order of a state's poses. */
export interface WelcomeNews {
  readonly type: "welcome";
  readonly protocol: number;
  readonly view: number;
  readonly bodies: readonly string[];
}

/** Whose right, forward and up the sticks follow. */
export type AxesChoice = "camera" | "robot";

export type Vector = readonly [number, number, number];

/** Where a camera stands, World, m; the focal point is in the middle of its picture. */
export interface CameraPose {
  readonly position: Vector;
  readonly focalPoint: Vector;
  readonly viewUp: Vector;
  readonly viewAngleDeg: number;
}

/** The scene's file, and what goes with it: fiducials by label in the head's frame, m. */
export interface SceneNews {
  readonly type: "scene";
  readonly url: string;
  readonly task: string;
  readonly sticks: AxesChoice;
  readonly cameras: Readonly<Record<string, CameraPose>>;
  readonly fiducials: Readonly<Record<string, Vector>>;
  readonly noGo: Readonly<Record<string, readonly string[]>>;
}

export type Pose = readonly [number, number, number, number, number, number, number];

/** How near the tool is to the head; `proximity` means within the 20 mm sphere. */
export type Proximity = "free" | "proximity" | "contact";

/** The state of the next touch; the last four are errors, which views show in red. */
export type TouchStage = "far" | "near" | "on skin" | "pressed" | "too deep" | "elsewhere" | "shaft" | "arm";

/** Bodies of the arm that cover tip or next point, which views draw translucent. */
export interface CoveringBodies {
  readonly view: readonly string[];
  readonly inset: readonly string[];
  readonly headset: readonly string[];
}

/** The state of a trial. */
export type Phase = "idle" | "running" | "paused" | "complete" | "verifying" | "aligning" | "drilling" | "inserting" | "registered" | "scored";

/** The robot's tool. All have the pointer's tip and axis; drill and electrode pass through */
export type Tool = "pointer" | "guide" | "drill" | "electrode";

/** Offset of the planned line from the guide's axis, seen along the axis: right and up. */
export interface GuideAim {
  readonly entryMm: readonly [number, number];
  readonly targetMm: readonly [number, number];
  readonly entryDistanceMm: number;
  readonly angleDeg: number;
}

/** State of the tool in a procedure: how far it is fed beyond the guide's tip. */
export interface ProcedureNews {
  readonly name: string;
  readonly tool: Tool;
  readonly feedMm: number;
  readonly aim: GuideAim | null;
}

/** Where a worn headset's eyes and its controllers are; None without one. */
export interface HeadsetPose {
  readonly eyes: Pose | null;
  readonly left: Pose | null;
  readonly right: Pose | null;
}

/** State of the simulation, sent 60 times a second. */
export interface StateNews {
  readonly type: "state";
  readonly tick: number;
  readonly timeS: number;
  readonly poses: readonly Pose[];
  readonly ghost: Readonly<Record<string, Pose>> | null;
  readonly clearanceMm: number;
  readonly proximity: Proximity;
  readonly touch: TouchStage;
  readonly camera: string;
  readonly view: CameraPose;
  readonly inset: CameraPose | null;
  readonly translucent: CoveringBodies;
  readonly phase: Phase;
  readonly next: string | null;
  readonly touched: readonly string[];
  readonly elapsedS: number;
  readonly plannedTarget: Vector | null;
  readonly delayed: number;
  readonly procedure: ProcedureNews | null;
  readonly headset: HeadsetPose | null;
}

/** How a sentence or a figure is meant; a view gives each its color. */
export type Tone = "plain" | "good" | "warning" | "error";

/** One line of a table of results, its value with the unit. */
export interface Fact { readonly label: string; readonly value: string; readonly tone: Tone; }

/** The kind of an item. */
export type ItemKind = "button" | "choice" | "text" | "axis";

/** One line of a menu; a view sends its name back when it is clicked. */
export interface MenuItem {
  readonly name: string;
  readonly label: string;
  readonly kind: ItemKind;
  readonly value: string;
  readonly isEnabled: boolean;
  readonly help: string;
  readonly picture: string;
}

/** A trainee's scores as a small plot of bars, oldest first; as text for who cannot see it. */
export interface ScoreTrend {
  readonly text: string;
  readonly scores: readonly number[];
  readonly mark: number;
}

/** The meaning of a line in a slice; a view gives each its color and shape. */
export type SliceMark = "skin" | "point" | "trace" | "residual" | "target" | "reached" | "tip";

/** A line in a slice, or its single points: right and up from the slice's middle, mm. */
export interface SliceLine {
  readonly mark: SliceMark;
  readonly points: readonly (readonly [number, number])[];
}

/** A slice of the images; `letters` name the patient's sides at its left, right, bottom, top. */
export interface Slice {
  readonly name: string;
  readonly letters: readonly string[];
  readonly lines: readonly SliceLine[];
}

/** The name of a mark. */
export interface SliceLegend { readonly mark: SliceMark; readonly name: string; }

/** Slices of the images, all to one scale; as text for people who cannot see them. */
export interface HeadSlices {
  readonly text: string;
  readonly slices: readonly Slice[];
  readonly legend: readonly SliceLegend[];
}

/** A sentence to the trainee. */
export interface ScreenMessage { readonly text: string; readonly tone: Tone; }

/** A panel over the picture; its name is never shown. */
export interface Menu {
  readonly name: string;
  readonly title: string;
  readonly paragraphs: readonly string[];
  readonly facts: readonly Fact[];
  readonly items: readonly MenuItem[];
  readonly focus: string;
  readonly picture: "" | "gamepad" | "keyboard" | "controllers";
  readonly trend: ScoreTrend | null;
  readonly slices: HeadSlices | null;
  readonly clock: ScreenMessage | null;
}

/** Which control does what at the moment, such as "A" and "Touch". */
export interface Hint { readonly control: string; readonly action: string; readonly item: string; }

/** The error of one touch, or a line of a procedure, drawn in the scene in its tone's color. */
export interface ErrorArrow {
  readonly begin: Vector;
  readonly end: Vector;
  readonly tone: Tone;
  readonly name: string;
}

/** A scale along the axis of the locked guide: planned distances from its tip. */
export interface DepthRuler {
  readonly entryMm: number;
  readonly outerMm: number | null;
  readonly innerMm: number | null;
  readonly targetMm: number;
  readonly names: readonly string[];
}

/** Everything except the scene. */
export interface Screen {
  readonly menu: Menu | null;
  readonly instruction: ScreenMessage;
  readonly warnings: readonly ScreenMessage[];
  readonly status: readonly string[];
  readonly hints: readonly Hint[];
  readonly language: string;
  readonly isSpoken: boolean;
  readonly hasSticks: boolean;
  readonly sticksNavigate: boolean;
  readonly hasArrow: boolean;
  readonly errors: readonly ErrorArrow[];
  readonly isHeadClear: boolean;
  readonly coverage: string;
  readonly ruler: DepthRuler | null;
  readonly isPrivate: boolean;
}

/** A new screen: everything that the trainee reads. */
export interface ScreenNews { readonly type: "screen"; readonly screen: Screen; }

/** A sound and a vibration of a `FeedbackEvent`, to be played once. */
export interface Feedback {
  readonly type: "event";
  readonly number: number;
  readonly kind: string;
  readonly sound: string;
  readonly volume: number;
  readonly rumble: number;
  readonly rumbleMs: number;
}

/** The holder of control, "" for nobody; `is_you` is true for the view that holds it. */
export interface ControlNews {
  readonly type: "control";
  readonly holder: string;
  readonly isYou: boolean;
}

/** How another view is paired; only for views on the simulator's own computer. */
export interface PairingNews {
  readonly type: "pairing";
  readonly code: string;
  readonly addresses: readonly string[];
}

/** A point on the skin in the head's frame (RAS), and the outward unit normal there. */
export interface SkinPlace { readonly positionMm: Vector; readonly normal: Vector; }

/** New points of a trace over the skin, in the head's frame; `known` earlier points remain. */
export interface TraceNews {
  readonly type: "trace";
  readonly known: number;
  readonly points: readonly Vector[];
  readonly coveredMm: number;
  readonly next: SkinPlace | null;
}

/** A view's description of itself when it joins. */
export interface Hello {
  readonly type: "hello";
  readonly kind: "desktop" | "page" | "headset" | "spectator" | "board";
  readonly device: string;
  readonly refreshHz: number;
}

/** A key went down or up: its W3C `KeyboardEvent.code`, and the text that it types. */
export interface KeyInput {
  readonly type: "key";
  readonly code: string;
  readonly isDown: boolean;
  readonly text: string;
}

/** Labels of the keys by their codes, such as "q" on KeyA in France. */
export interface LayoutInput {
  readonly type: "layout";
  readonly keys: Readonly<Record<string, string>>;
}

/** A gamepad that the browser reads: axes −1 to 1 and buttons 0 to 1 of the W3C gamepad. */
export interface PadInput {
  readonly type: "pad";
  readonly axes: readonly number[];
  readonly buttons: readonly number[];
}

/** Sticks of XR controllers or on the screen, as in `OperatorInput`. */
export interface SticksInput {
  readonly type: "sticks";
  readonly translation: Vector;
  readonly rotation: readonly [number, number];
  readonly fine: boolean;
  readonly yawDeg: number;
}

/** A turn of the view: around to the right, higher, and its distance multiplied. */
export interface OrbitInput {
  readonly type: "orbit";
  readonly aroundDeg: number;
  readonly higherDeg: number;
  readonly zoom: number;
}

/** One press of a control, by its name in the settings of the controls. */
export interface PressInput { readonly type: "press"; readonly control: string; }

/** A click on an item of the menu or of a hint. */
export interface ItemInput { readonly type: "item"; readonly name: string; }

/** The new text of a text item. */
export interface TextInput { readonly type: "text"; readonly name: string; readonly value: string; }

/** How much of a task's scene a view has loaded; 1 once it is drawn. */
export interface PictureProgress {
  readonly type: "picture";
  readonly task: string;
  readonly share: number;
}

/** How smoothly a view has drawn during the last second. */
export interface Frames {
  readonly type: "frames";
  readonly shown: number;
  readonly dropped: number;
  readonly refreshHz: number;
}

/** Whether the trainee sees the view: the headset was doffed, the page hidden. */
export interface Visibility { readonly type: "visibility"; readonly isVisible: boolean; }

/** Where a headset and its controllers are, at most 30 times a second. */
export interface HeadsetInput {
  readonly type: "headsetPose";
  readonly eyes: Pose | null;
  readonly left: Pose | null;
  readonly right: Pose | null;
}

/** A sign of life: everything held is still held. */
export interface Alive { readonly type: "alive"; }

/** State of the connection to a seat. */
export type SeatLink = "connecting" | "watching" | "away" | "unpaired" | "other certificate";

/** State of a seat and its trial. `rejected` counts refused touches. */
export interface SeatReport {
  readonly trainee: string;
  readonly task: string;
  readonly count: number;
  readonly screen: string;
  readonly instruction: string;
  readonly warnings: readonly string[];
  readonly score: number | null;
  readonly holder: string;
  readonly slicer: boolean;
  readonly language: string;
  readonly assignments: string;
  readonly phase: Phase;
  readonly touched: number;
  readonly rejected: number;
  readonly elapsedS: number;
  readonly touch: TouchStage;
}

/** A seat on the board; `seat` is None while it is not watched. */
export interface TileNews {
  readonly id: string;
  readonly name: string;
  readonly address: string;
  readonly link: SeatLink;
  readonly seat: SeatReport | null;
}

/** The seats of a board, at most four times a second. */
export interface TilesNews { readonly type: "tiles"; readonly seats: readonly TileNews[]; }

/** An assignment in the table of a class, in the page's language. */
export interface AssignmentColumn {
  readonly name: string;
  readonly label: string;
  readonly goal: string;
}

/** Where a trainee stands with an assignment: `LOCKED` waits for others to be reached. */
export type AssignmentState = "locked" | "open" | "reached";

/** A trainee's standing in an assignment; `reached_utc` is "" until it is reached. */
export interface AssignmentCell {
  readonly state: AssignmentState;
  readonly progress: string;
  readonly done: number;
  readonly needed: number;
  readonly reachedUtc: string;
}

/** A trainee in the table of a class; `next` is "" once all assignments are reached. */
export interface TraineeRow {
  readonly trainee: string;
  readonly reached: number;
  readonly next: string;
  readonly cells: readonly AssignmentCell[];
}

/** Where the trainees of one curriculum stand. */
export interface CurriculumTable {
  readonly title: string;
  readonly assignments: readonly AssignmentColumn[];
  readonly trainees: readonly TraineeRow[];
}

/** Answer to `GET /class`. */
export interface ClassNews {
  readonly hasStudy: boolean;
  readonly problem: string;
  readonly asOf: string;
  readonly curricula: readonly CurriculumTable[];
  readonly without: readonly string[];
}

/** Orders that a teacher can give to a seat. */
export type InstructorOrder = "pause" | "say" | "replay";

/** The role for which a client was paired. */
export type ViewRole = "view" | "spectator" | "board";

export type News =
  | WelcomeNews
  | SceneNews
  | StateNews
  | ScreenNews
  | Feedback
  | ControlNews
  | PairingNews
  | TraceNews;

export type ViewInput =
  | Hello
  | KeyInput
  | LayoutInput
  | PadInput
  | SticksInput
  | OrbitInput
  | PressInput
  | ItemInput
  | TextInput
  | PictureProgress
  | Frames
  | Visibility
  | HeadsetInput
  | Alive;

export const SUBPROTOCOL = "rastrainer.views.1";
export const MAX_KEY_TEXT = 16;
export const MAX_ITEM_TEXT = 200;
export const MAX_DEVICE_TEXT = 80;
export const MAX_FRAMES = 10000;
export const BOARD_SUBPROTOCOL = "rastrainer.board.1";
export const TOUCH_ERRORS = ["too deep", "elsewhere", "shaft", "arm"] as const;
export const TONES = {"plain": "#3f8fe0", "good": "#8ff0d0", "warning": "#ffe000", "error": "#ef5f66"} as const;
export const BANNERS = {"plain": "#0f2f70", "good": "#35786a", "warning": "#806f00", "error": "#700d18"} as const;
export const NIGHT = "#0e1726";
export const TEXT = "#f4f7fb";
export const TARGET_COLOR = "#ffe14a";
export const SCENE_COLORS = {"waiting": [0.07, 0.2, 0.6], "next": [1.0, 0.88, 0.29], "touched": [0.18, 0.6, 0.29], "free": [0.06, 0.27, 0.91], "near": [0.29, 0.65, 1.0], "onSkin": [0.65, 1.0, 0.4], "error": [0.78, 0.0, 0.1], "traced": [0.02, 0.13, 0.42], "covered": [0.34, 0.71, 0.91], "ghost": [0.5, 0.34, 0.9]} as const;
export const PULSE_COLOR = [1.0, 0.97, 0.75] as const;
export const PULSE_S = 1.4;
export const GHOST_OPACITY = 0.45;
export const CLEAR_SKIN_OPACITY = 0.3;
export const COVER_OPACITY = 0.3;
export const TOOL_NODES = {"pointer": [], "guide": ["guide", "axis"], "drill": ["guide", "drill"], "electrode": ["guide", "electrode"]} as const;
export const INSTRUMENTS = ["drill", "electrode"] as const;
export const FLIGHT_S = 0.7;
export const IN_SIGHT_SHARE = 0.9;
export const CLOSED_RING_M = 0.005;
export const ARROW_RADIUS_M = 0.001;
export const ARROW_BALL_M = 0.0022;
export const MAX_TRACE_POINTS = 500;
export const TRACE_MARK_M = 0.0011;
export const TRACE_RING_M = [0.0052, 0.0075] as const;
export const TRACE_RIM_M = [0.0075, 0.0088] as const;
export const TRACE_LIFT_M = 0.003;
export const TRACE_RING_SIDES = 40;
export const FULL_PAINT_SHARE = 0.5;
export const BULLS_EYE_RADIUS = 156;
export const BULLS_EYE_RINGS_MM = [1, 5, 20] as const;
export const BULLS_EYE_FARTHEST_MM = 60;
export const BULLS_EYE_NEAR_MM = 0.6;
export const ON_LINE_MM = 0.5;
export const ON_LINE_DEG = 0.5;
export const ENTRY_DOT = 9;
export const TARGET_RING = 15;
export const RULER_TICK_MM = 10;
export const RULER_BEYOND_MM = 10;

