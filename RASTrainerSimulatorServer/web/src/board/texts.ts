/** Texts of the teacher's board, in the language of the browser. */

import * as german from "../texts/de.json";
import * as english from "../texts/en.json";
import * as spanish from "../texts/es.json";
import * as frenchTexts from "../texts/fr.json";
import { chinese, french, withUnits, writtenLanguage } from "../texts/typesetting";
import * as chineseTexts from "../texts/zh-Hans.json";

export type BoardText = keyof typeof english.board;

interface Texts {
  page: Readonly<Record<string, string>>;
  board: Readonly<Record<BoardText, string>>;
}

const LANGUAGES: Readonly<Record<string, Texts>> = {
  en: english,
  de: german,
  fr: { page: french(frenchTexts.page), board: french(frenchTexts.board) },
  es: spanish,
  zh: { page: chinese(chineseTexts.page), board: chinese(chineseTexts.board) },
};
const language = navigator.language.slice(0, 2);
const { page, board } = LANGUAGES[language] ?? english;
document.documentElement.lang = language in LANGUAGES ? writtenLanguage(language) : "en";

/** Name of the device that drives an arm, as on its seat's page. */
export function holderName(holder: string): string {
  return page[`source.${holder}`] ?? holder;
}

export function say(name: BoardText, values: Readonly<Record<string, string>> = {}): string {
  return withUnits(board[name].replace(/\{(\w+)\}/g, (whole, key: string) => values[key] ?? whole));
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
