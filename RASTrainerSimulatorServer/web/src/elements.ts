/** Short ways to the page's elements. */

export function byId(id: string): HTMLElement {
  return document.getElementById(id)!;
}

export function element<Tag extends keyof HTMLElementTagNameMap>(tag: Tag, text: string): HTMLElementTagNameMap[Tag] {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}
