/** The teacher's board: live tiles of several simulators. */

import { byId } from "../elements";
import { BOARD_SUBPROTOCOL, type InstructorOrder, type TileNews, type TilesNews } from "../generated";
import { isCodeGiven, pair } from "../stream/pairing";
import { streamUrl } from "../stream/served";
import { ClassSection } from "./class_section";
import { ask } from "./dialogs";
import { say } from "./texts";
import { isTraining, Tile } from "./tiles";

const RETRY_MS = 1000;
const NOTICE_MS = 8000;

class Board {
  private readonly tiles = new Map<string, Tile>();
  private readonly classSection = new ClassSection();
  private hiding = 0;

  constructor() {
    document.title = `${say("title")} – RASTrainer`;
    document.querySelector("h1")!.textContent = say("title");
    byId("empty").textContent = say("empty");
    const add = byId("add") as HTMLButtonElement;
    add.textContent = say("add");
    add.onclick = () => void this.add();
  }

  async begin(): Promise<void> {
    if (isCodeGiven() || !(await isPaired())) await pair(byId("pairing") as HTMLFormElement, say);
    byId("add").hidden = false;
    this.join();
    void this.classSection.begin();
  }

  private join(): void {
    const socket = new WebSocket(streamUrl("tiles"), BOARD_SUBPROTOCOL);
    let wasOpen = false;
    socket.onopen = () => {
      wasOpen = true;
      this.notify("");
    };
    socket.onmessage = (event) => this.show((JSON.parse(event.data) as TilesNews).seats);
    socket.onclose = () => void this.comeBack(wasOpen);
  }

  private async comeBack(wasOpen: boolean): Promise<void> {
    if (!wasOpen && !(await isPaired())) {
      location.reload();
      return;
    }
    this.notify(say("lost"), "warning", true);
    window.setTimeout(() => this.join(), RETRY_MS);
  }

  private show(seats: readonly TileNews[]): void {
    const list = byId("seats");
    const known = new Set(seats.map(({ id }) => id));
    for (const [id, tile] of this.tiles) {
      if (known.has(id)) continue;
      tile.element.remove();
      this.tiles.delete(id);
    }
    seats.forEach((news, place) => {
      let tile = this.tiles.get(news.id);
      if (tile === undefined) {
        tile = new Tile(news, {
          order: (of, order) => void this.order(of, order),
          remove: (of) => void this.remove(of),
          repair: (of) => void this.add(of),
        });
        this.tiles.set(news.id, tile);
      } else tile.show(news);
      if (list.children[place] !== tile.element) list.insertBefore(tile.element, list.children[place] ?? null);
    });
    this.classSection.showSeats(seats);
    byId("empty").hidden = seats.length > 0;
    const watching = seats.filter(({ seat }) => seat !== null).length;
    const values = { watching: String(watching), all: String(seats.length), running: String(seats.filter(isTraining).length) };
    const count = seats.length > 0 ? say("count", values) : "";
    if (byId("count").textContent !== count) byId("count").textContent = count;
  }

  /** Pair with a simulator, anew where a seat is given. */
  private async add(known?: TileNews): Promise<void> {
    let fingerprint = "";
    const fields = [
      { name: "name", label: "name", help: "nameHelp", value: known?.name, maxLength: 40 },
      { name: "address", label: "address", help: "addressHelp", value: known?.address, maxLength: 300 },
      { name: "code", label: "seatCode", maxLength: 6 },
    ] as const;
    const values = await ask({ title: say(known ? "repair" : "add"), fields, accept: "next" }, async (entered) => {
      const { problem, answer } = await send("seats", "POST", entered);
      fingerprint = (answer.fingerprint as string | undefined) ?? "";
      return problem;
    });
    if (values === null || fingerprint === "") return;
    await ask({ title: say("add"), text: say("compare"), fingerprint, accept: "same" }, async () => {
      const { problem } = await send("seats", "POST", { ...values, fingerprint });
      return problem;
    });
  }

  private async remove({ id, name }: TileNews): Promise<void> {
    await ask({ title: say("remove"), text: say("removeAsk", { name }), accept: "remove" }, async () => {
      const { problem } = await send(`seat/${id}`, "DELETE");
      return problem;
    });
  }

  private async order({ id, name }: TileNews, order: InstructorOrder): Promise<void> {
    const path = `seat/${id}/order`;
    let text = "";
    if (order === "say") {
      const fields = [{ name: "text", label: "sentence", maxLength: 200 }] as const;
      const values = await ask({ title: `${say("say")}: ${name}`, fields, accept: "send" });
      if (values === null) return;
      text = values.text ?? "";
    }
    const { problem, answer } = await send(path, "POST", { order, text });
    if (problem !== "") {
      this.notify(say("failed", { name, reason: problem }));
      return;
    }
    if (answer.needsPin === true) {
      const fields = [{ name: "pin", label: "pin", help: "pinHelp", type: "password", maxLength: 12 }] as const;
      const values = await ask({ title: name, fields, accept: "send" }, async ({ pin }) => (await send(path, "POST", { order, text, pin })).problem);
      if (values === null) return;
    }
    this.notify(say(`done.${order}`, { name }), "good");
  }

  private notify(text: string, tone: "warning" | "good" = "warning", stays = false): void {
    window.clearTimeout(this.hiding);
    const notice = byId("notice");
    notice.textContent = text;
    notice.hidden = text === "";
    notice.dataset.tone = tone;
    if (!stays) this.hiding = window.setTimeout(() => (notice.hidden = true), NOTICE_MS);
  }
}

interface Answered {
  /** What went wrong, "" for nothing. */
  problem: string;
  answer: Record<string, unknown>;
}

async function send(path: string, method: string, values: object = {}): Promise<Answered> {
  try {
    const response = await fetch(path, { method, body: JSON.stringify(values) });
    if (!response.ok) return { problem: await response.text(), answer: {} };
    return { problem: "", answer: (await response.json()) as Record<string, unknown> };
  } catch {
    return { problem: say("lost"), answer: {} };
  }
}

async function isPaired(): Promise<boolean> {
  try {
    return (await fetch("paired")).status !== 401;
  } catch {
    return true;
  }
}

void new Board().begin();
