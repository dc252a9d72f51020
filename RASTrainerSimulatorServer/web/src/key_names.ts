/** The labels of this keyboard's keys, by their places. */

interface LayoutKeyboard {
  getLayoutMap(): Promise<ReadonlyMap<string, string>>;
}

const WRITES = /^(Key.|Digit.|Minus|Equal|Bracket.+|Back(slash|quote)|Semicolon|Quote|Comma|Period|Slash|Intl.+)$/;
const names = new Map<string, string>();

/** Ask the browser for the names; only some know them, and tell them to pages of a secure origin. */
export async function readKeyNames(): Promise<void> {
  const { keyboard } = navigator as Navigator & { keyboard?: LayoutKeyboard };
  // It is refused to a page in a frame of another.
  const layout = await keyboard?.getLayoutMap().catch(() => null);
  layout?.forEach((name, code) => learn(code, name));
}

/** Learn the name of a key that is pressed; return whether it is new. */
export function learnKeyName(event: KeyboardEvent): boolean {
  const { code, key } = event;
  const isShifted = event.shiftKey || event.getModifierState("AltGraph") || event.getModifierState("CapsLock");
  const isLetter = key.toLowerCase() !== key.toUpperCase();
  return (isLetter || !isShifted) && learn(code, key.toLowerCase());
}

export function keyNames(): Readonly<Record<string, string>> {
  return Object.fromEntries(names);
}

/** Return the label of the key that has a letter or digit on an American keyboard. */
export function nameOf(american: string): string {
  const name = names.get(/[0-9]/.test(american) ? `Digit${american}` : `Key${american}`) ?? american;
  const capital = name.toUpperCase();
  return capital.length === 1 ? capital : name;
}

function learn(code: string, name: string): boolean {
  if (!WRITES.test(code) || [...name].length !== 1 || names.get(code) === name) return false;
  names.set(code, name);
  return true;
}
