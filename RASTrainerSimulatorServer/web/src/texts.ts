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

export function say(name: TextName, source = ""): string {
  return table[name].replace("{source}", source);
}

/** Who drives the arm, as people read it. */
export function sayHolder(holder: string, isYou: boolean): string {
  if (holder === "") return say("nobody");
  const name = `source.${holder}`;
  const source = name in table ? table[name as TextName] : holder;
  return say(isYou ? "you" : "other", source);
}
