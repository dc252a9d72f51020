/** What the teacher's board says, in the language of the browser. */

import * as chinese from "../texts/chinese";
import * as english from "../texts/english";
import * as french from "../texts/french";
import * as german from "../texts/german";
import * as spanish from "../texts/spanish";
import { writtenLanguage } from "../texts/typesetting";

export type BoardText = keyof english.BoardTexts;

interface Texts {
  PAGE: english.PageTexts;
  BOARD: english.BoardTexts;
}

const LANGUAGES: Readonly<Record<string, Texts>> = { en: english, de: german, fr: french, es: spanish, zh: chinese };
const language = navigator.language.slice(0, 2);
const { PAGE, BOARD } = LANGUAGES[language] ?? english;
document.documentElement.lang = language in LANGUAGES ? writtenLanguage(language) : "en";

/** What drives an arm, as the page of its seat calls it. */
export function holderName(holder: string): string {
  const name = `source.${holder}`;
  return name in PAGE ? PAGE[name as keyof english.PageTexts] : holder;
}

export function say(name: BoardText, values: Readonly<Record<string, string>> = {}): string {
  return BOARD[name].replace(/\{(\w+)\}/g, (whole, key: string) => values[key] ?? whole);
}

/** Return a figure with the language's decimal sign. */
export function figure(value: number, digits: number): string {
  return value.toLocaleString(document.documentElement.lang, { minimumFractionDigits: digits, maximumFractionDigits: digits });
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
