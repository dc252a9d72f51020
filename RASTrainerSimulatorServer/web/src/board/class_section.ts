/** The section of the class: asks the board for its table again and again, and reports problems. */

import { byId, element } from "../elements";
import type { ClassNews, TileNews } from "../generated";
import { ClassTable } from "./class_table";
import { standingMark } from "./standing_mark";
import { age, moment, say } from "./texts";

const ROUND_MS = 2000;
const STATES = ["reached", "open", "locked"] as const;

export class ClassSection {
  private tables: ClassTable[] = [];
  private seats: ReadonlyMap<string, string> = new Map();

  constructor() {
    byId("class-title").textContent = say("class");
    byId("to-class").textContent = say("class");
    byId("class-legend").append(
      ...STATES.map((state) => {
        const entry = element("li", say(`legend.${state}`));
        const mark = standingMark(state, 0.3);
        mark.dataset.state = state;
        entry.prepend(mark);
        return entry;
      }),
    );
  }

  async begin(): Promise<void> {
    const language = document.documentElement.lang;
    for (;;) {
      try {
        const response = await fetch(`class?language=${language}`);
        if (response.ok) this.show((await response.json()) as ClassNews);
      } catch {
        // The board says that the connection is lost.
      }
      await new Promise((done) => window.setTimeout(done, ROUND_MS));
    }
  }

  /** Show at which seat each trainee is. */
  showSeats(tiles: readonly TileNews[]): void {
    const seats = new Map<string, string>();
    for (const { name, seat } of tiles) {
      if (seat === null || seat.trainee === "") continue;
      const others = seats.get(seat.trainee);
      seats.set(seat.trainee, others === undefined ? name : `${others}, ${name}`);
    }
    this.seats = seats;
    for (const table of this.tables) table.showSeats(seats);
  }

  private show(news: ClassNews): void {
    const { hasStudy, problem, asOf, curricula, without } = news;
    const isSame = curricula.length === this.tables.length && curricula.every((each, place) => this.tables[place]!.show(each));
    if (!isSame) {
      this.tables = curricula.map((each, place) => new ClassTable(each, place + 1));
      byId("class-tables").replaceChildren(...this.tables.map((table) => table.element));
      for (const table of this.tables) table.showSeats(this.seats);
    }
    const isEmpty = curricula.length === 0;
    document.body.toggleAttribute("data-class", !isEmpty);
    byId("class").hidden = false;
    byId("to-class").hidden = isEmpty;
    byId("class-legend").hidden = isEmpty;
    setText("class-problem", problem === "" ? "" : say("classProblem", { reason: problem }));
    setText("class-state", stateOf(news));
    setText("class-age", asOf === "" ? "" : ageOf(new Date(asOf), problem !== ""));
    byId("class").toggleAttribute("data-problem", problem !== "");
    setText("class-without", isEmpty || without.length === 0 || !hasStudy ? "" : say("classWithout", { names: without.join(", ") }));
  }
}

function ageOf(read: Date, isOld: boolean): string {
  return isOld ? say("classOld", { time: moment(read), age: age(read) }) : say("classAsOf", { time: moment(read) });
}

/** Say why there is no table; "" where there is one. */
function stateOf({ hasStudy, asOf, curricula, without }: ClassNews): string {
  if (!hasStudy) return say("classHow");
  if (asOf === "" || curricula.length > 0) return "";
  return say(without.length === 0 ? "classEmpty" : "classNoCurriculum");
}

function setText(id: string, text: string): void {
  const shown = byId(id);
  if (shown.textContent !== text) shown.textContent = text;
  shown.hidden = text === "";
}
