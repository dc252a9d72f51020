/** What the page says itself, because the simulator cannot or does not know. */

import { page as german } from "./texts/de.json";
import { page as english } from "./texts/en.json";
import { page as spanish } from "./texts/es.json";
import { page as frenchTexts } from "./texts/fr.json";
import { chinese, french, withUnits, writtenLanguage } from "./texts/typesetting";
import { page as chineseTexts } from "./texts/zh-Hans.json";

export type TextName = keyof typeof english;

const TABLES: Readonly<Record<string, Readonly<Record<TextName, string>>>> = {
  en: english,
  de: german,
  fr: french(frenchTexts),
  es: spanish,
  zh: chinese(chineseTexts),
};
let table = TABLES.en!;
useLanguage(navigator.language);

/** Speak the language that the simulator's texts are in; English where there is no table of it. */
export function useLanguage(tag: string): void {
  const language = tag.slice(0, 2);
  table = TABLES[language] ?? english;
  document.documentElement.lang = language in TABLES ? writtenLanguage(tag) : "en";
}

export function say(name: TextName, values: Readonly<Record<string, string>> = {}): string {
  return withUnits(table[name].replace(/\{(\w+)\}/g, (whole, key: string) => values[key] ?? whole));
}

/** Who drives the arm, as people read it. */
export function sayHolder(holder: string, isYou: boolean): string {
  if (holder === "") return say("nobody");
  const name = `source.${holder}`;
  const source = name in table ? table[name as TextName] : holder;
  return say(isYou ? "you" : "other", { source });
}
