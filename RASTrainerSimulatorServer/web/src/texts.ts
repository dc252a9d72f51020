/** What the page says itself, because the simulator cannot or does not know. */

import * as chinese from "./texts/chinese";
import * as english from "./texts/english";
import * as french from "./texts/french";
import * as german from "./texts/german";
import * as spanish from "./texts/spanish";
import { writtenLanguage } from "./texts/typesetting";

export type TextName = keyof english.PageTexts;

const TABLES: Readonly<Record<string, english.PageTexts>> = {
  en: english.PAGE,
  de: german.PAGE,
  fr: french.PAGE,
  es: spanish.PAGE,
  zh: chinese.PAGE,
};
let table = english.PAGE;
useLanguage(navigator.language);

/** Speak the language that the simulator's texts are in; English where there is no table of it. */
export function useLanguage(tag: string): void {
  const language = tag.slice(0, 2);
  table = TABLES[language] ?? english.PAGE;
  document.documentElement.lang = language in TABLES ? writtenLanguage(tag) : "en";
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
