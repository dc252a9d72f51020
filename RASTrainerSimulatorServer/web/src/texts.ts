/** The page's own sentences, for states that the simulator cannot tell or does not know. */

import { page as de } from "./texts/de.json";
import { page as en } from "./texts/en.json";
import { page as es } from "./texts/es.json";
import { page as fr } from "./texts/fr.json";
import { typeset, withUnits, writtenLanguage } from "./texts/typesetting";
import { page as zh } from "./texts/zh-Hans.json";

export type TextName = keyof typeof en;
export type Values = Readonly<Record<string, string>>;

const TABLES = typeset({ de, en, es, fr, zh });
let table: Readonly<Record<TextName, string>> = en;
useLanguage(navigator.language);

/** Speak the language of the simulator's texts, or English if there is no table of it. */
export function useLanguage(tag: string): void {
  const language = tag.slice(0, 2);
  table = TABLES[language] ?? en;
  document.documentElement.lang = language in TABLES ? writtenLanguage(tag) : "en";
}

export function say(name: TextName, values: Values = {}): string {
  return filled(table[name], values);
}

/** Name of the device that drives an arm. */
export function holderName(holder: string): string {
  const name = `source.${holder}`;
  return name in table ? table[name as TextName] : holder;
}

/** Return the holder of the control, in words. */
export function sayHolder(holder: string, isYou: boolean): string {
  return holder === "" ? say("nobody") : say(isYou ? "you" : "other", { source: holderName(holder) });
}

/** Return a number with one decimal, as the language writes it. */
export function figure(value: number): string {
  const digits = { minimumFractionDigits: 1, maximumFractionDigits: 1 };
  return value.toLocaleString(document.documentElement.lang, digits);
}

/** Return a text with values in its placeholders. */
export function filled(text: string, values: Values): string {
  return withUnits(text.replace(/\{(\w+)\}/g, (whole, key: string) => values[key] ?? whole));
}
