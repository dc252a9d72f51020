/** What the teacher's board says, in the language of the browser. */

import * as chinese from "../texts/chinese";
import * as english from "../texts/english";
import * as french from "../texts/french";
import * as german from "../texts/german";
import * as spanish from "../texts/spanish";
import { writtenLanguage } from "../texts/typesetting";

export type BoardText = keyof english.BoardTexts;

const TABLES: Readonly<Record<string, english.BoardTexts>> = {
  en: english.BOARD,
  de: german.BOARD,
  fr: french.BOARD,
  es: spanish.BOARD,
  zh: chinese.BOARD,
};
const language = navigator.language.slice(0, 2);
const table = TABLES[language] ?? english.BOARD;
document.documentElement.lang = language in TABLES ? writtenLanguage(language) : "en";

export function say(name: BoardText, values: Readonly<Record<string, string>> = {}): string {
  return table[name].replace(/\{(\w+)\}/g, (whole, key: string) => values[key] ?? whole);
}

/** Return a figure with the language's decimal sign. */
export function figure(value: number, digits: number): string {
  return value.toLocaleString(document.documentElement.lang, { minimumFractionDigits: digits, maximumFractionDigits: digits });
}
