/** What the page says itself, because the simulator cannot or does not know. */

const ENGLISH = {
  title: "RASTrainer",
  pair: "Pair this browser with the simulator",
  code: "Pairing code",
  codeHelp: "Six digits: the simulator shows them where it was started.",
  join: "Connect",
  watch: "Only watch",
  takePart: "You only watch: pair to take part",
  lost: "The connection to the simulator was lost. It will be restored as soon as the simulator answers.",
  connecting: "Connecting to the simulator …",
  noScene: "The scene cannot be loaded. Reload the page.",
  noPicture:
    "This browser cannot draw the 3D picture (WebGL is missing or switched off). Menus and results work; to train, use another browser.",
  loading: "Loading the scene: {loaded} of {total} MB",
  loadingSome: "Loading the scene: {loaded} MB",
  scene: "Scene",
  view: "Robot, head and operating room",
  status: "Status",
  wrongCode: "This is not the pairing code that the simulator shows.",
  newCode: "There were too many wrong codes. The simulator now shows a new code: enter it in {seconds} s.",
  oldCode: "The pairing code in the address is no longer valid. Enter the code that the simulator shows now.",
  restarted: "The simulator does not know this browser anymore. Enter the code that it shows now.",
  enter: "Enter the headset",
  leave: "Leave the headset",
  noHeadset: "No headset here",
  insecure: "A headset needs https or this computer itself",
  recenter: "Recenter",
  higher: "Table higher",
  lower: "Table lower",
  grab: "Grip moves the tip: on",
  noGrab: "Grip moves the tip: off",
  nobody: "Nobody drives the robot yet",
  you: "You drive: {source}",
  other: "The robot is driven by: {source}",
  closeUp: "Close-up",
  far: "Overview",
  beside: "Along the skin",
  across: "Across the line",
  pairing: "To pair another view: code {code} at {address}",
  picture: "Where each input is",
  "touch.touch": "Touch",
  "touch.undo": "Undo",
  "touch.camera": "Front view",
  "touch.best_view": "Best view",
  "touch.menu": "Pause",
  "touch.fine": "Slow",
  "touch.tilt": "Tilt",
  "touch.tilting": "Tilt, turn",
  "touch.left": "Left, right, forward, back",
  "touch.right": "Up, down, turn",
  "part.cross": "D-pad",
  "part.leftStick": "Left stick",
  "part.rightStick": "Right stick",
  "part.back": "Back button",
  "part.start": "Start button",
  "part.trigger": "Trigger",
  "part.grip": "Grip",
  "part.space": "Space",
  "part.enter": "Enter",
  "part.backspace": "Backspace",
  "part.leftShift": "Left Shift",
  "part.rightShift": "Right Shift",
  "source.gamepad": "gamepad",
  "source.keyboard": "keyboard",
  "source.mouse": "mouse",
  "source.touch screen": "touch screen",
  "source.browser's gamepad": "browser's gamepad",
  "source.headset's controllers": "headset's controllers",
};

const GERMAN: typeof ENGLISH = {
  title: "RASTrainer",
  pair: "Diesen Browser mit dem Simulator koppeln",
  code: "Kopplungscode",
  codeHelp: "Sechs Ziffern: Der Simulator zeigt sie dort, wo er gestartet wurde.",
  join: "Verbinden",
  watch: "Nur zuschauen",
  takePart: "Du schaust nur zu: koppeln, um mitzumachen",
  lost: "Die Verbindung zum Simulator ist unterbrochen. Sobald er antwortet, geht es weiter.",
  connecting: "Verbindung zum Simulator …",
  noScene: "Die Szene kann nicht geladen werden. Lade die Seite neu.",
  noPicture:
    "Dieser Browser kann das 3D-Bild nicht zeichnen (WebGL fehlt oder ist abgeschaltet). Menüs und Ergebnisse funktionieren; nimm zum Üben einen anderen Browser.",
  loading: "Die Szene wird geladen: {loaded} von {total} MB",
  loadingSome: "Die Szene wird geladen: {loaded} MB",
  scene: "Szene",
  view: "Roboter, Kopf und Operationssaal",
  status: "Status",
  wrongCode: "Das ist nicht der Kopplungscode, den der Simulator zeigt.",
  newCode: "Es gab zu viele falsche Codes. Der Simulator zeigt jetzt einen neuen Code: Gib ihn in {seconds} s ein.",
  oldCode: "Der Kopplungscode in der Adresse gilt nicht mehr. Gib den Code ein, den der Simulator jetzt zeigt.",
  restarted: "Der Simulator kennt diesen Browser nicht mehr. Gib den Code ein, den er jetzt zeigt.",
  enter: "Ins Headset wechseln",
  leave: "Headset verlassen",
  noHeadset: "Kein Headset vorhanden",
  insecure: "Ein Headset braucht https oder diesen Rechner selbst",
  recenter: "Neu ausrichten",
  higher: "Tisch höher",
  lower: "Tisch tiefer",
  grab: "Griff führt die Spitze: an",
  noGrab: "Griff führt die Spitze: aus",
  nobody: "Noch steuert niemand den Roboter",
  you: "Du steuerst: {source}",
  other: "Den Roboter steuert: {source}",
  closeUp: "Nahansicht",
  far: "Übersicht",
  beside: "Entlang der Haut",
  across: "Quer zur Linie",
  pairing: "Weitere Ansicht koppeln: Code {code} auf {address}",
  picture: "Wo welche Eingabe liegt",
  "touch.touch": "Berühren",
  "touch.undo": "Zurücknehmen",
  "touch.camera": "Von vorn",
  "touch.best_view": "Beste Ansicht",
  "touch.menu": "Pause",
  "touch.fine": "Langsam",
  "touch.tilt": "Kippen",
  "touch.tilting": "Kippen, drehen",
  "touch.left": "Links, rechts, vor, zurück",
  "touch.right": "Auf, ab, drehen",
  "part.cross": "Steuerkreuz",
  "part.leftStick": "Linker Stick",
  "part.rightStick": "Rechter Stick",
  "part.back": "Back-Taste",
  "part.start": "Start-Taste",
  "part.trigger": "Trigger",
  "part.grip": "Griff",
  "part.space": "Leertaste",
  "part.enter": "Eingabe",
  "part.backspace": "Rücktaste",
  "part.leftShift": "Umschalt links",
  "part.rightShift": "Umschalt rechts",
  "source.gamepad": "Gamepad",
  "source.keyboard": "Tastatur",
  "source.mouse": "Maus",
  "source.touch screen": "Touchscreen",
  "source.browser's gamepad": "Gamepad des Browsers",
  "source.headset's controllers": "Controller des Headsets",
};

export type TextName = keyof typeof ENGLISH;

const TABLES: Readonly<Record<string, typeof ENGLISH>> = { en: ENGLISH, de: GERMAN };
let table = ENGLISH;
useLanguage(navigator.language);

/** Speak the language that the simulator's texts are in; English where there is no table of it. */
export function useLanguage(tag: string): void {
  const language = tag.slice(0, 2);
  table = TABLES[language] ?? ENGLISH;
  document.documentElement.lang = language in TABLES ? tag : "en";
}

export function say(name: TextName, values: Readonly<Record<string, string>> = {}): string {
  return table[name].replace(/\{(\w+)\}/g, (whole, key: string) => values[key] ?? whole);
}

/** Who drives the arm, as people read it. */
export function sayHolder(holder: string, isYou: boolean): string {
  if (holder === "") return say("nobody");
  const name = `source.${holder}`;
  const source = name in table ? table[name as TextName] : holder;
  return say(isYou ? "you" : "other", { source });
}
