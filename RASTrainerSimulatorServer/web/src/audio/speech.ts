/** Screens read aloud by the browser's own voices, one sentence after the other. */

import type { Screen } from "../generated";

export class Speech {
  /** Sentences of the present screen, the most urgent first. */
  private shown: readonly string[] = [];
  /** Those that have been read. */
  private said = new Set<string>();
  private language = "";
  private isReading = false;

  /** Read the new sentences of a screen, except those that are gone before their turn. */
  show(screen: Screen): void {
    this.shown = screen.isSpoken ? sentences(screen) : [];
    this.said = new Set(this.shown.filter((text) => this.said.has(text)));
    this.language = screen.language;
    if (this.isReading && this.shown.length === 0) speechSynthesis.cancel();
    this.readNext();
  }

  private readNext(): void {
    const text = this.shown.find((each) => !this.said.has(each));
    if (this.isReading || text === undefined || !("speechSynthesis" in window)) return;
    this.said.add(text);
    this.isReading = true;
    const utterance = new SpeechSynthesisUtterance(text);
    // Voices are named by region.
    utterance.lang = this.language === "zh-Hans" ? "zh-CN" : this.language;
    utterance.onend = utterance.onerror = () => {
      this.isReading = false;
      this.readNext();
    };
    speechSynthesis.speak(utterance);
  }
}

function sentences({ menu, instruction, warnings }: Screen): string[] {
  const texts = [...warnings.map((each) => each.text), instruction.text];
  if (menu !== null) {
    const focused = menu.items.find((item) => item.name === menu.focus);
    texts.push(menu.title, ...menu.paragraphs);
    texts.push(...menu.facts.map((fact) => `${fact.label}: ${fact.value}`));
    texts.push(menu.slices?.text ?? "", menu.trend?.text ?? "");
    texts.push(focused === undefined ? "" : `${focused.label} ${focused.value}`.trim(), focused?.help ?? "");
  }
  return [...new Set(texts.filter((text) => text !== ""))];
}
