/** A panel in the room that shows elements of the page, in the page's style. */

import type { Vector2 } from "three";

import { byId, element } from "../elements";
import { Panel } from "./panel";
import { COLORS, Pen } from "./pen";

/** Pixels of a unit of the style sheet: the largest with which all fits, and enough choices of a menu are in sight. */
const UNITS = [1.3, 1.2, 1.1, 1, 0.9] as const;
/** How many choices are in sight at least, if there are so many. */
const LEAST_ROWS = 4;
const BAR = 10;
/** Parts that scroll a list, by how much of its height, for who can only point; no item has such a name. */
const SCROLLS: Readonly<Record<string, number>> = { "scroll up": -0.8, "scroll down": 0.8 };
const SCROLL_SIZE = 68;
/** So many pixels of a list may be hidden: no row is. */
const UNSEEN = 12;
const SVG = "http://www.w3.org/2000/svg";
/** A clock changes every second: its text is written onto the picture, which is not drawn again for it. */
const CLOCK = /^\d+:\d\d$/;

/** A part that can be chosen by pointing at it, in pixels of the canvas. */
export interface Region {
  readonly name: string;
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/**
 * The page arranges the elements, invisible. A browser draws elements on a canvas only as an SVG picture
 * (`foreignObject`), which holds its own style sheet and loads nothing: pictures are drawn on top of it.
 */
export class ElementPanel extends Panel {
  /** Parent of the elements. */
  readonly root = element("div");
  regions: readonly Region[] = [];
  private readonly context: CanvasRenderingContext2D;
  private picture: HTMLImageElement | null = null;
  private wanted = "";
  private painted = "";
  private isPainting = false;
  private isShown = false;
  private hovered = "";
  private focused: Element | null = null;

  /** Make a panel of `width` × `height` pixels, `wide` m wide. */
  constructor(width: number, height: number, wide: number) {
    const canvas = element("canvas");
    canvas.width = width;
    canvas.height = height;
    super(canvas, wide);
    this.context = canvas.getContext("2d")!;
    this.root.className = "panel";
    this.root.style.width = `${width}px`;
    this.root.style.height = `${height}px`;
    byId("room").append(this.root);
    this.mesh.userData.panel = this;
  }

  /** Show or hide the panel; it appears once its elements are drawn. */
  show(isShown: boolean): void {
    this.isShown = isShown;
    this.mesh.visible = isShown && this.isPainted;
  }

  /** Whether the picture shows the present elements. */
  get isPainted(): boolean {
    return this.painted !== "" && this.painted === this.wanted;
  }

  /** Draw the elements if they have changed. */
  update(): void {
    this.root.lang = document.documentElement.lang;
    for (const image of this.root.querySelectorAll("img")) if (!image.complete) image.onload = () => this.update();
    this.layOut();
    const parts = this.root.querySelectorAll<HTMLElement>("[data-name], [data-item]");
    this.regions = [...this.scrollRegions(), ...[...parts].flatMap((part) => this.regionOf(part))];
    this.wanted = this.markup();
    if (this.wanted === this.painted) this.compose();
    else void this.paint();
  }

  /** Mark the part that is pointed at. */
  hover(name: string): void {
    if (name === this.hovered) return;
    this.hovered = name;
    this.compose();
  }

  /** Return the name of the part at a texture coordinate, "" for none. */
  at(uv: Vector2): string {
    const x = uv.x * this.canvas.width;
    const y = (1 - uv.y) * this.canvas.height;
    const hit = this.regions.find((part) => x >= part.x && x <= part.x + part.width && y >= part.y && y <= part.y + part.height);
    return hit?.name ?? "";
  }

  /** Scroll the list if that is what a part is for; return whether it is. */
  scroll(name: string): boolean {
    const share = SCROLLS[name];
    if (share === undefined || this.list === null) return false;
    this.list.scrollTop += share * this.list.clientHeight;
    this.update();
    return true;
  }

  override dispose(): void {
    this.root.remove();
    super.dispose();
  }

  private get list(): HTMLElement | null {
    return this.root.querySelector<HTMLElement>(".menu > ul");
  }

  private layOut(): void {
    const { list } = this;
    const rows = [...(list?.children ?? [])];
    const content = this.root.firstElementChild;
    for (const unit of UNITS) {
      this.root.style.setProperty("--u", `${unit}px`);
      const least = rows[Math.min(rows.length, LEAST_ROWS) - 1];
      const areRowsInSight = !list || !least || this.boxOf(least).bottom - this.boxOf(rows[0]!).top <= list.clientHeight;
      if (areRowsInSight && (!content || content.scrollHeight <= content.clientHeight)) break;
    }
    const focused = list?.querySelector("[data-focus]") ?? null;
    // A list that was scrolled stays so until the focus moves.
    if (focused !== this.focused) focused?.scrollIntoView({ block: "nearest" });
    this.focused = focused;
  }

  /** Return a button at each end of the list behind which there is more. */
  private scrollRegions(): Region[] {
    const { list } = this;
    if (list === null) return [];
    const { right, top, bottom } = this.boxOf(list);
    const left = list.scrollHeight - list.clientHeight - list.scrollTop;
    const place = { x: right - SCROLL_SIZE / 2, width: SCROLL_SIZE, height: SCROLL_SIZE };
    return [
      ...(list.scrollTop > UNSEEN ? [{ ...place, name: "scroll up", y: top }] : []),
      ...(left > UNSEEN ? [{ ...place, name: "scroll down", y: bottom - SCROLL_SIZE }] : []),
    ];
  }

  private regionOf(part: HTMLElement): Region[] {
    const { x, y, width, height } = this.boxOf(part);
    const name = part.dataset.item ?? part.dataset.name ?? "";
    const clip = this.list?.contains(part) ? this.boxOf(this.list) : null;
    const middle = y + height / 2;
    const isInSight = clip === null || (middle > clip.top && middle < clip.bottom);
    const isEnabled = part.querySelector("[aria-disabled='true']") === null;
    return isInSight && isEnabled ? [{ name, x, y, width, height }] : [];
  }

  private boxOf(part: Element | Range): DOMRect {
    const { left, top } = this.root.getBoundingClientRect();
    const box = part.getBoundingClientRect();
    return new DOMRect(box.x - left, box.y - top, box.width, box.height);
  }

  /** Return the elements as an SVG picture. */
  private markup(): string {
    const copy = this.root.cloneNode(true) as HTMLElement;
    const images = this.root.querySelectorAll("img");
    copy.querySelectorAll("img").forEach((image, index) => {
      const gap = element("div");
      gap.style.height = `${images[index]!.offsetHeight}px`;
      image.replaceWith(gap);
    });
    const fields = this.root.querySelectorAll("input");
    copy.querySelectorAll("input").forEach((field, index) => field.setAttribute("value", fields[index]!.value));
    for (const clock of clocksIn(copy)) {
      clock.style.visibility = "hidden";
      clock.textContent = clock.textContent!.replace(/\d/g, "0");
    }
    const { list } = this;
    const first = copy.querySelector<HTMLElement>(".menu > ul > li");
    if (first && list) first.style.marginTop = `calc(${getComputedStyle(list.firstElementChild!).marginTop} - ${list.scrollTop}px)`;
    const picture = document.createElementNS(SVG, "svg");
    picture.setAttribute("width", `${this.canvas.width}`);
    picture.setAttribute("height", `${this.canvas.height}`);
    // The tones of the root, whose background would be the picture's.
    picture.setAttribute("style", `${document.documentElement.style.cssText}; background: none`);
    const style = document.createElementNS(SVG, "style");
    style.textContent = styleSheet ||= pageStyle();
    const frame = document.createElementNS(SVG, "foreignObject");
    frame.setAttribute("width", "100%");
    frame.setAttribute("height", "100%");
    frame.append(copy);
    picture.append(style, frame);
    return new XMLSerializer().serializeToString(picture);
  }

  private async paint(): Promise<void> {
    if (this.isPainting) return;
    this.isPainting = true;
    while (!this.isPainted) {
      const markup = this.wanted;
      const picture = new Image();
      picture.src = `data:image/svg+xml,${encodeURIComponent(markup)}`;
      await picture.decode();
      this.picture = picture;
      this.painted = markup;
    }
    this.isPainting = false;
    this.compose();
    this.mesh.visible = this.isShown;
  }

  /** Add the parts that the picture of the elements lacks: pictures, clocks, scroll bar and highlight. */
  private compose(): void {
    const { context, canvas, list, picture } = this;
    if (picture === null) return;
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.drawImage(picture, 0, 0);
    for (const image of this.root.querySelectorAll("img")) this.place(image);
    for (const clock of clocksIn(this.root)) this.write(clock);
    if (list && list.scrollHeight > list.clientHeight + UNSEEN) {
      const { right, top, height } = this.boxOf(list);
      const share = height / list.scrollHeight;
      this.box(right + BAR / 2, top, BAR, height, COLORS.field);
      this.box(right + BAR / 2, top + share * list.scrollTop, BAR, share * height, COLORS.pale);
      for (const { name, x, y } of this.scrollRegions()) this.drawScroll(x + SCROLL_SIZE / 2, y + SCROLL_SIZE / 2, Math.sign(SCROLLS[name]!));
    }
    const pointed = this.regions.find(({ name }) => name === this.hovered);
    if (pointed) {
      context.strokeStyle = COLORS.accentEdge;
      context.lineWidth = 4;
      context.beginPath();
      context.roundRect(pointed.x + 2, pointed.y + 2, pointed.width - 4, pointed.height - 4, 16);
      context.stroke();
    }
    this.texture.needsUpdate = true;
  }

  private box(x: number, y: number, width: number, height: number, color: string): void {
    this.context.fillStyle = color;
    this.context.fillRect(x, y, width, height);
  }

  /** Draw a disk with an arrow that points down (1) or up (−1). */
  private drawScroll(x: number, y: number, down: number): void {
    const { context } = this;
    const pen = new Pen(context);
    pen.circle(x, y, SCROLL_SIZE / 2 - 4, COLORS.field);
    pen.circle(x, y, SCROLL_SIZE / 2 - 4, COLORS.pale, 3);
    for (const side of [-1, 1]) pen.stroke(x + 13 * side, y - 6 * down, x, y + 8 * down, COLORS.text, 6);
  }

  /** Draw a picture as large as fits in its element, once it is loaded. */
  private place(image: HTMLImageElement): void {
    if (!image.complete || image.naturalWidth === 0) return;
    const { x, y, width, height } = this.boxOf(image);
    const factor = Math.min(width / image.naturalWidth, height / image.naturalHeight);
    const [across, down] = [factor * image.naturalWidth, factor * image.naturalHeight];
    this.context.drawImage(image, x + (width - across) / 2, y + (height - down) / 2, across, down);
  }

  private write(clock: HTMLElement): void {
    const { context } = this;
    const { color, fontWeight, fontSize, fontFamily } = getComputedStyle(clock);
    const text = new Range();
    text.selectNodeContents(clock);
    const { x, y, height } = this.boxOf(text);
    context.font = `${fontWeight} ${fontSize} ${fontFamily}`;
    context.fillStyle = color;
    context.textBaseline = "middle";
    context.fillText(clock.textContent!, x, y + height / 2);
  }
}

/** The page's style as text: put together once, as every picture holds it. */
let styleSheet = "";

function pageStyle(): string {
  return [...document.styleSheets].flatMap((sheet) => [...sheet.cssRules].map((rule) => rule.cssText)).join("\n");
}

function clocksIn(parent: HTMLElement): HTMLElement[] {
  return [...parent.querySelectorAll<HTMLElement>(".status li, .clock")].filter((line) => CLOCK.test(line.textContent!));
}
