/** Texts and times on the teacher's board, in the language of the browser. */

import { filled, useLanguage, type Values } from "../texts";
import { board as de } from "../texts/de.json";
import { board as en } from "../texts/en.json";
import { board as es } from "../texts/es.json";
import { board as fr } from "../texts/fr.json";
import { typeset } from "../texts/typesetting";
import { board as zh } from "../texts/zh-Hans.json";

export { figure, holderName } from "../texts";
export type BoardText = keyof typeof en;

const language = navigator.language.slice(0, 2);
const table: Readonly<Record<BoardText, string>> = typeset({ de, en, es, fr, zh })[language] ?? en;
useLanguage(language);

export function say(name: BoardText, values: Values = {}): string {
  return filled(table[name], values);
}

/** Return a day, such as "Nov 26, 2026". */
export function date(when: Date): string {
  return when.toLocaleDateString(document.documentElement.lang, { dateStyle: "medium" });
}

/** Return a day with its time. */
export function moment(when: Date): string {
  return when.toLocaleString(document.documentElement.lang, { dateStyle: "medium", timeStyle: "medium" });
}

/** Return how long ago something was, such as "3 minutes ago". */
export function age(when: Date): string {
  const seconds = Math.max(0, Math.round((Date.now() - when.getTime()) / 1000));
  const [unit, length] = seconds < 60 ? (["second", 1] as const) : seconds < 3600 ? (["minute", 60] as const) : (["hour", 3600] as const);
  return new Intl.RelativeTimeFormat(document.documentElement.lang).format(-Math.floor(seconds / length), unit);
}
