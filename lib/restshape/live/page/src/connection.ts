// The socket to the server: it comes back by itself after it was lost, and pings so that a lost one is noticed.

import type { FrameMessage, FromPage, FromServer } from "./protocol";

/** What `FromPage` is without its number, which the connection gives. */
export type Asked = FromPage extends infer One ? (One extends FromPage ? Omit<One, "id"> : never) : never;

export interface Listener {
  message(message: FromServer): void;
  /** `bytes` holds the arrays: that of an `ArrayPlace` begins at `base + place.at`. */
  frame(header: FrameMessage, bytes: ArrayBuffer, base: number): void;
  /** Whether the socket is open; where it is not, whether another tab has it, or the session has ended. */
  connected(open: boolean, why?: "elsewhere" | "ended"): void;
}

const QUIET = 20_000; // ms without a word of the server, which says one every 5 s, after which the socket counts as lost
const TAKEN = 20; // ms after which the server is told of frames that were taken, where no other message says so before
const AGAIN = 500; // ms until the first try to connect again; each further one waits longer
const LONGEST = 5_000;
const ENDED = 1001; // code of a socket that was closed because the session has ended in order
const REPLACED = 4001; // code of a socket that was closed because the same page has opened another one

export class Connection {
  private socket: WebSocket | null = null;
  private id = 1_000 * Date.now(); // so that numbers grow from page to page, and none comes twice
  private wait = AGAIN;
  private heard = 0;
  private taken = 0; // frames of which the server was not told yet
  private telling = 0;
  private timer = 0;

  constructor(private readonly listener: Listener) {
    this.connect();
    setInterval(() => this.watch(), 1_000);
    // A laptop that wakes up, and a network that comes back, need no wait.
    addEventListener("online", () => this.hurry());
    document.addEventListener("visibilitychange", () => { if (!document.hidden) this.hurry(); });
  }

  /** Sends a message; its number, or 0 where there is no socket. */
  send(asked: Asked): number {
    if (this.socket?.readyState !== WebSocket.OPEN) return 0;
    this.id += 1;
    const { taken } = this;
    this.taken = 0;
    this.socket.send(JSON.stringify(taken ? { ...asked, id: this.id, shown: taken } : { ...asked, id: this.id }));
    return this.id;
  }

  private connect(): void {
    clearTimeout(this.timer);
    const address = new URL("socket", location.href);
    address.searchParams.set("page", pageName());
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.taken = 0;
    this.heard = performance.now();
    socket.onopen = () => { this.wait = AGAIN; this.listener.connected(true); };
    socket.onclose = (event) => { if (this.socket === socket) this.lost(event.code); };
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      this.heard = performance.now();
      if (typeof event.data !== "string") { this.take(event.data); return; }
      if (event.data) this.listener.message(JSON.parse(event.data) as FromServer);
    };
  }

  private take(bytes: ArrayBuffer): void {
    const length = new DataView(bytes).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length))) as FrameMessage;
    this.listener.frame(header, bytes, 4 + length);
    // The server sends no further frames to a page that is busy with those it has. Most often the hand's next place says so.
    this.taken += 1;
    if (this.taken > 1) this.tell();
    else {
      clearTimeout(this.telling);
      this.telling = window.setTimeout(() => this.tell(), TAKEN);
    }
  }

  private tell(): void {
    clearTimeout(this.telling);
    if (this.taken) this.send({ type: "shown" });
  }

  private lost(code: number): void {
    if (code !== REPLACED && code !== ENDED) { this.again(); return; }
    this.socket = null; // until the person looks at this page again
    this.listener.connected(false, code === ENDED ? "ended" : "elsewhere");
  }

  private again(): void {
    this.socket = null;
    this.listener.connected(false);
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.connect(), this.wait);
    this.wait = Math.min(2 * this.wait, LONGEST);
  }

  private watch(): void {
    if (!this.socket || performance.now() - this.heard < QUIET) return;
    const lost = this.socket;
    this.again();
    lost.close();
  }

  private hurry(): void {
    if (!this.socket) { this.wait = AGAIN; this.connect(); }
  }
}

/** A name by which the server knows this page again when it is reloaded, or its socket was lost. */
function pageName(): string {
  try {
    const known = sessionStorage.getItem("restshape page") ?? unnamed;
    sessionStorage.setItem("restshape page", known);
    return known;
  } catch {
    return unnamed; // a frame of another page, as in a notebook, may have no storage
  }
}

const unnamed = crypto.randomUUID();
