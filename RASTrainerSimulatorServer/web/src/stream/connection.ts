/** Stay connected to the simulator, and reconnect whenever it was away. */

import { SUBPROTOCOL, type Hello, type News, type ViewInput, type ViewRole } from "../generated";
import { streamUrl } from "./served";

const RETRY_MS = 1000;
/** A view that holds something says so at least this often; the simulator releases it after 0.5 s. */
const ALIVE_MS = 150;
const LOOK_MS = 50;
/** The simulator says something 60 times a second: after so long it cannot be heard any more. */
const SILENCE_MS = 3000;
/** This many checks without a message between: what arrived while the page itself was stalled is read by then. */
const SILENT_LOOKS = 5;

export interface ConnectionListener {
  /** A message has come. */
  onNews(news: News): void;
  /** The stream has begun, or it is gone. */
  onConnected(isConnected: boolean): void;
  /** The simulator does not know this browser (any more): it has to be paired. */
  onUnknown(): void;
}

export class Connection {
  private socket: WebSocket | null = null;
  private isWanted = false;
  private lastSent = 0;
  private lastHeard = 0;
  private silentLooks = 0;

  constructor(
    private hello: Hello,
    private readonly listener: ConnectionListener,
  ) {
    window.setInterval(() => this.look(), LOOK_MS);
  }

  /** Returns whether something is held that the simulator must not release. */
  isHolding: () => boolean = () => false;

  get isConnected(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  /** Whether this page only watches: the simulator would end what sends more than signs of life. */
  get isWatching(): boolean {
    return this.hello.kind === "spectator";
  }

  start(hello: Hello): void {
    this.hello = hello;
    this.isWanted = true;
    this.join();
  }

  /** Join again as another kind of view: the page becomes a headset, or a page again. */
  rejoin(hello: Hello): void {
    this.hello = hello;
    this.socket?.close();
    this.join();
  }

  /** Send a message; without a connection, input does not count. */
  send(message: ViewInput): void {
    if (this.isConnected && !this.isWatching) {
      this.lastSent = performance.now();
      this.socket?.send(JSON.stringify(message));
    }
  }

  private join(): void {
    const socket = new WebSocket(streamUrl("stream"), SUBPROTOCOL);
    this.socket = socket;
    let wasOpen = false;
    socket.onopen = () => {
      wasOpen = true;
      this.hear();
      socket.send(JSON.stringify(this.hello));
      this.listener.onConnected(true);
    };
    socket.onmessage = (event) => {
      if (socket !== this.socket) return;
      this.hear();
      this.listener.onNews(JSON.parse(event.data) as News);
    };
    socket.onclose = () => {
      if (socket === this.socket) this.lose(wasOpen);
    };
  }

  private hear(): void {
    this.lastHeard = performance.now();
    this.silentLooks = 0;
  }

  private lose(wasOpen: boolean): void {
    this.socket = null;
    this.listener.onConnected(false);
    void this.comeBack(wasOpen);
  }

  private async comeBack(wasOpen: boolean): Promise<void> {
    if (!wasOpen && (await readRole()) === null) {
      this.isWanted = false;
      this.listener.onUnknown();
      return;
    }
    window.setTimeout(() => {
      if (this.isWanted && this.socket === null) this.join();
    }, RETRY_MS);
  }

  private look(): void {
    const now = performance.now();
    this.silentLooks++;
    const isSilent = this.silentLooks >= SILENT_LOOKS && now - this.lastHeard > SILENCE_MS;
    const { socket } = this;
    if (socket !== null && this.isConnected && isSilent) {
      // A lost network sends no close frame, and waits long for the other side's.
      this.lose(true);
      socket.close();
    }
    if (this.isHolding() && now - this.lastSent >= ALIVE_MS) this.send({ type: "alive" });
  }
}

let known: ViewRole = "view";

/** Return what this browser was paired for, null if it is not; a simulator that is away knows everyone. */
export async function readRole(): Promise<ViewRole | null> {
  try {
    const answer = await fetch("role");
    if (answer.status === 401) return null;
    if (answer.ok) known = ((await answer.json()) as { role: ViewRole }).role;
  } catch {
    // It is away.
  }
  return known;
}
