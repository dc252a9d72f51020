/** What the page says itself, because the simulator cannot or does not know. */

const ENGLISH = {
  title: "RASTrainer",
  pair: "Pair this browser with the simulator",
  code: "Pairing code",
  codeHelp: "Six digits: the simulator shows them where it was started.",
  join: "Join",
  lost: "The connection to the simulator is lost. It is joined again as soon as it answers.",
  connecting: "Joining the simulator …",
  noScene: "The scene cannot be loaded. Reload the page.",
  enter: "Enter the headset",
  leave: "Leave the headset",
  noHeadset: "No headset here",
  insecure: "A headset needs https or this computer itself",
  recenter: "Recenter",
  higher: "Table higher",
  lower: "Table lower",
  grab: "Grab to move: on",
  noGrab: "Grab to move: off",
  nobody: "Nobody drives the robot yet",
  you: "You drive: {source}",
  other: "The robot is driven by: {source}",
  closeUp: "Close-up",
  far: "Overview",
  beside: "Along the skin",
  pairing: "To pair another view: code {code} at {address}",
  picture: "Which input is where",
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
  "source.browser's gamepad": "browser's gamepad",
  "source.headset's controllers": "headset's controllers",
};

const GERMAN: typeof ENGLISH = {
  title: "RASTrainer",
  pair: "Diesen Browser mit dem Simulator koppeln",
  code: "Kopplungscode",
  codeHelp: "Sechs Ziffern: Der Simulator zeigt sie dort, wo er gestartet wurde.",
  join: "Verbinden",
  lost: "Die Verbindung zum Simulator ist unterbrochen. Sobald er antwortet, geht es weiter.",
  connecting: "Verbindung zum Simulator …",
  noScene: "Die Szene kann nicht geladen werden. Lade die Seite neu.",
  enter: "Ins Headset wechseln",
  leave: "Headset verlassen",
  noHeadset: "Kein Headset vorhanden",
  insecure: "Ein Headset braucht https oder diesen Rechner selbst",
  recenter: "Neu ausrichten",
  higher: "Tisch höher",
  lower: "Tisch tiefer",
  grab: "Greifen und Führen: an",
  noGrab: "Greifen und Führen: aus",
  nobody: "Noch steuert niemand den Roboter",
  you: "Du steuerst: {source}",
  other: "Den Roboter steuert: {source}",
  closeUp: "Nahansicht",
  far: "Übersicht",
  beside: "Entlang der Haut",
  pairing: "Weitere Ansicht koppeln: Code {code} auf {address}",
  picture: "Wo welche Eingabe liegt",
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
  "part.leftShift": "Linke Umschalttaste",
  "part.rightShift": "Rechte Umschalttaste",
  "source.gamepad": "Gamepad",
  "source.keyboard": "Tastatur",
  "source.mouse": "Maus",
  "source.browser's gamepad": "Gamepad des Browsers",
  "source.headset's controllers": "Controller des Headsets",
};

export type TextName = keyof typeof ENGLISH;

const TABLES: Readonly<Record<string, typeof ENGLISH>> = { en: ENGLISH, de: GERMAN };
let table = TABLES[navigator.language.slice(0, 2)] ?? ENGLISH;

/** Speak the language that the simulator's texts are in. */
export function useLanguage(tag: string): void {
  table = TABLES[tag.slice(0, 2)] ?? ENGLISH;
  document.documentElement.lang = tag;
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
