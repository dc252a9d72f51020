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
