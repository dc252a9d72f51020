/** The class: a table for each curriculum, trainees by assignments, which is sorted by the buttons in its head. */

import { element } from "../elements";
import type { AssignmentCell, CurriculumTable, TraineeRow } from "../generated";
import { standingMark } from "./standing_mark";
import { date, say } from "./texts";

export type SortKey = "trainee" | "reached";
const KEYS: readonly SortKey[] = ["trainee", "reached"];
const byName = new Intl.Collator(undefined, { numeric: true });

/** A table that keeps its head, so that the focus stays on its buttons, and gets new rows. */
export class ClassTable {
  readonly element = element("div");
  private readonly body = element("tbody");
  private readonly heads: Record<SortKey, HTMLTableCellElement>;
  private readonly sort: { key: SortKey; isDown: boolean } = { key: "trainee", isDown: false };
  private seats: ReadonlyMap<string, string> = new Map();

  constructor(
    private news: CurriculumTable,
    number: number,
  ) {
    const caption = element("caption", "", { id: `class-${number}` });
    caption.append(element("span", news.title));
    this.heads = { trainee: this.sortable("trainee"), reached: this.sortable("reached") };
    const row = element("tr");
    row.append(...KEYS.map((key) => this.heads[key]), head(say("nextTask")), head(say("seat")));
    row.append(...news.assignments.map(({ label, name }) => head(label, name)));
    const top = element("thead");
    top.append(row);
    const table = element("table");
    table.append(caption, top, this.body);
    const scroller = element("div", "", { className: "scroller", tabIndex: 0, role: "region" });
    scroller.setAttribute("aria-labelledby", caption.id);
    scroller.append(table);
    const goals = element("ul");
    goals.append(...news.assignments.map(({ label, name, goal }) => element("li", say("goal", { label, name, goal }))));
    this.element.append(scroller, goals);
    this.fill();
  }

  /** Show news of the same assignments; return false for another curriculum, which needs another table. */
  show(news: CurriculumTable): boolean {
    const { title, assignments } = this.news;
    if (JSON.stringify([title, assignments]) !== JSON.stringify([news.title, news.assignments])) return false;
    if (JSON.stringify(this.news) !== JSON.stringify(news)) {
      this.news = news;
      this.fill();
    }
    return true;
  }

  /** Show at which seat each trainee is; `seats` has their names by the trainee. */
  showSeats(seats: ReadonlyMap<string, string>): void {
    this.seats = seats;
    for (const row of this.body.rows) {
      const [name, , , seat] = row.cells;
      const place = seats.get(name!.textContent!) ?? say("none");
      if (seat!.textContent !== place) seat!.textContent = place;
    }
  }

  private sortable(key: SortKey): HTMLTableCellElement {
    const made = head("");
    const button = element("button", say(key), { type: "button" });
    button.onclick = () => {
      const { sort } = this;
      sort.isDown = sort.key === key ? !sort.isDown : key === "reached";
      sort.key = key;
      this.fill();
    };
    made.replaceChildren(button);
    return made;
  }

  private fill(): void {
    const { key, isDown } = this.sort;
    for (const name of KEYS) {
      if (name === key) this.heads[name].setAttribute("aria-sort", isDown ? "descending" : "ascending");
      else this.heads[name].removeAttribute("aria-sort");
    }
    const sign = isDown ? -1 : 1;
    const sorted = [...this.news.trainees].sort((one, other) => {
      const names = byName.compare(one.trainee, other.trainee);
      return key === "trainee" ? sign * names : sign * (progressOf(one) - progressOf(other)) || names;
    });
    this.body.replaceChildren(...sorted.map((trainee) => rowOf(trainee)));
    this.showSeats(this.seats);
  }
}

/** A trainee's progress: assignments reached, and shares of the open assignments. */
function progressOf({ cells }: TraineeRow): number {
  return cells.reduce((sum, { state, done, needed }) => sum + (state === "locked" ? 0 : done / needed), 0);
}

function rowOf({ trainee, reached, next, cells }: TraineeRow): HTMLTableRowElement {
  const row = element("tr");
  const name = element("th", trainee, { scope: "row" });
  const places = [`${reached} / ${cells.length}`, next || say("allReached"), say("none")].map((text) => element("td", text));
  row.append(name, ...places, ...cells.map(cellOf));
  return row;
}

function cellOf({ state, progress, done, needed, reachedUtc }: AssignmentCell): HTMLTableCellElement {
  const cell = element("td");
  cell.dataset.state = state;
  cell.append(standingMark(state, done / needed), element("span", progress));
  if (reachedUtc !== "") {
    cell.append(element("time", date(new Date(reachedUtc)), { dateTime: reachedUtc }));
  }
  return cell;
}

function head(text: string, name = ""): HTMLTableCellElement {
  const made = element("th", text, { scope: "col" });
  if (name !== "") made.append(element("small", name));
  return made;
}
