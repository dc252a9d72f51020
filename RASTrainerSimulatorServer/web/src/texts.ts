/** What page and board say themselves, because the simulator cannot or does not know. */

import * as german from "./texts/de.json";
import * as english from "./texts/en.json";
import * as spanish from "./texts/es.json";
import * as frenchTexts from "./texts/fr.json";
import { chinese, french, withUnits, writtenLanguage } from "./texts/typesetting";
import * as chineseTexts from "./texts/zh-Hans.json";

export type TextName = keyof typeof english.page;
export type BoardText = keyof typeof english.board;
type Values = Readonly<Record<string, string>>;

interface Texts {
  readonly page: Readonly<Record<TextName, string>>;
  readonly board: Readonly<Record<BoardText, string>>;
}

const TABLES: Readonly<Record<string, Texts>> = {
  en: english,
  de: german,
  fr: { page: french(frenchTexts.page), board: french(frenchTexts.board) },
  es: spanish,
  zh: { page: chinese(chineseTexts.page), board: chinese(chineseTexts.board) },
};
let table: Texts = english;
useLanguage(navigator.language);

/** Speak the language that the simulator's texts are in; English where there is no table of it. */
export function useLanguage(tag: string): void {
  const language = tag.slice(0, 2);
  table = TABLES[language] ?? english;
  document.documentElement.lang = language in TABLES ? writtenLanguage(tag) : "en";
}

export function say(name: TextName, values: Values = {}): string {
  return filled(table.page[name], values);
}

export function sayOnBoard(name: BoardText, values: Values = {}): string {
  return filled(table.board[name], values);
}

/** Name of the device that drives an arm. */
export function holderName(holder: string): string {
  const name = `source.${holder}`;
  return name in table.page ? table.page[name as TextName] : holder;
}

/** Who drives the arm, as people read it. */
export function sayHolder(holder: string, isYou: boolean): string {
  return holder === "" ? say("nobody") : say(isYou ? "you" : "other", { source: holderName(holder) });
}

/** Return a number with one decimal, as the language writes it. */
export function figure(value: number): string {
  const digits = { minimumFractionDigits: 1, maximumFractionDigits: 1 };
  return value.toLocaleString(document.documentElement.lang, digits);
}

function filled(text: string, values: Values): string {
  return withUnits(text.replace(/\{(\w+)\}/g, (whole, key: string) => values[key] ?? whole));
}
