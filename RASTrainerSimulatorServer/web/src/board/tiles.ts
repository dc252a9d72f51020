/** One tile a seat: who, task, point, clock, contact, last score, and what the teacher can do. */

import { element } from "../elements";
import type { InstructorOrder, Phase, SeatReport, TileNews } from "../generated";
import { isTouchError } from "../stream/stages";
import { withUnits } from "../texts/typesetting";
import { figure, holderName, say, type BoardText } from "./texts";

export interface TileActions {
  order(tile: TileNews, order: InstructorOrder): void;
  remove(tile: TileNews): void;
  repair(tile: TileNews): void;
}

const WORKING: readonly Phase[] = ["running", "verifying", "aligning", "drilling", "inserting"];

export function isTraining({ seat }: TileNews): boolean {
  return seat !== null && WORKING.includes(seat.phase);
}

/** A tile that is changed in place, so that the focus stays on its buttons. */
export class Tile {
  readonly element = element("li");
  private readonly name = element("b");
  private readonly clock = element("span");
  private readonly who = element("p", "", { className: "who" });
  private readonly state = element("p", "", { className: "state" });
  private readonly says = element("p", "", { className: "says" });
  private readonly progress = element("progress", "", { ariaLabel: say("points") });
  private readonly facts = element("dl");
  private readonly watch = element("a", say("watch"), { className: "second", target: "_blank" });
  private readonly buttons: Record<InstructorOrder | "repair", HTMLButtonElement>;
  private news: TileNews;

  constructor(news: TileNews, actions: TileActions) {
    this.news = news;
    const head = element("h2");
    head.append(this.name, this.clock);
    const order = (name: InstructorOrder) => button(name, () => actions.order(this.news, name));
    this.buttons = {
      pause: order("pause"),
      say: order("say"),
      replay: order("replay"),
      repair: button("repair", () => actions.repair(this.news)),
    };
    const doings = element("div", "", { className: "doings" });
    doings.append(this.watch, ...Object.values(this.buttons), button("remove", () => actions.remove(this.news)));
    this.element.append(head, this.who, this.state, this.progress, this.says, this.facts, doings);
    this.show(news);
  }

  show(news: TileNews): void {
    this.news = news;
    const { seat } = news;
    this.name.textContent = news.name;
    this.watch.href = `seat/${news.id}/`;
    this.element.dataset.tone = toneOf(news);
    this.element.dataset.link = news.link;
    const isOpen = seat !== null && seat.task !== "";
    this.clock.textContent = isOpen ? clock(seat.elapsedS) : "";
    this.who.textContent = seat === null ? news.address : seat.trainee || say("nobody");
    this.state.textContent = stateOf(news);
    this.progress.hidden = !isOpen;
    this.progress.max = seat?.count || 1;
    this.progress.value = seat?.touched ?? 0;
    this.says.textContent = seat === null ? "" : saidAt(seat);
    this.facts.replaceChildren(...(seat === null ? [] : factsOf(seat).flatMap(([label, value]) => [element("dt", label), element("dd", withUnits(value))])));
    const isThere = seat !== null;
    this.watch.hidden = !isThere;
    for (const name of ["pause", "say", "replay"] as const) this.buttons[name].hidden = !isThere;
    this.buttons.pause.hidden = !isTraining(news);
    this.buttons.replay.hidden = seat?.phase !== "scored";
    this.buttons.repair.hidden = news.link !== "unpaired" && news.link !== "other certificate";
  }
}

function stateOf({ link, seat }: TileNews): string {
  if (seat === null) return say(link === "watching" ? "link.connecting" : `link.${link}`);
  const phase = say(`phase.${seat.phase}`);
  const doing = seat.task === "" ? phase : say("doing", { task: seat.task, phase });
  return WORKING.includes(seat.phase) ? say("doing.where", { doing, touch: say(`touch.${seat.touch}`) }) : doing;
}

/** The trainee's text: warnings, and the instruction or the open menu. */
function saidAt({ warnings, screen, instruction }: SeatReport): string {
  const last = screen === "" ? instruction : say("menu", { title: screen });
  return [...warnings, last].filter((text) => text !== "").join(" · ");
}

function toneOf(news: TileNews): string {
  const { link, seat } = news;
  if (seat === null) return link === "connecting" ? "" : "error";
  if (isTraining(news) && isTouchError(seat.touch)) return "error";
  if (seat.warnings.length > 0 || seat.phase === "paused") return "warning";
  return isTraining(news) ? "good" : "";
}

function factsOf(seat: SeatReport): [string, string][] {
  const facts: [string, string][] = [];
  if (seat.task !== "") {
    facts.push([say("points"), `${seat.touched} / ${seat.count}`], [say("refused"), String(seat.rejected)]);
  }
  if (seat.assignments !== "") facts.push([say("assignments"), seat.assignments]);
  facts.push(
    [say("score"), seat.score === null ? say("none") : `${figure(seat.score)} / 100`],
    [say("driven"), seat.holder === "" ? say("none") : holderName(seat.holder)],
    [say("slicer"), say(seat.slicer ? "connected" : "missing")],
  );
  return facts;
}

function clock(seconds: number): string {
  return `${String(Math.floor(seconds / 60)).padStart(2, "0")}:${String(seconds % 60).padStart(2, "0")}`;
}

function button(name: BoardText, press: () => void): HTMLButtonElement {
  return element("button", say(name), { type: "button", className: "second", onclick: press });
}
