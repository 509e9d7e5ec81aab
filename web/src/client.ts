// The socket: Foxglove's WebSocket protocol from the page's side.

import { Message, Schema, readMessage, readSchema } from "./cdr";

export interface Channel {
  id: number;
  topic: string;
  encoding: string;
  schemaName: string;
  schema: string;
}

interface Offered {
  id: number;
  name: string;
}

/** What the server says of itself. */
export interface Info {
  name: string;
  access: string;
  /** Where files lie on the server. */
  files: string;
  /** Another program than before: what the page shows is of the one before. */
  another: boolean;
  /** Of a recording [ns since the epoch]. */
  start?: number;
  end?: number;
}

export interface Playback {
  status: number;
  now: number;
  speed: number;
  sought: boolean;
}

export type Taker = (message: Message) => void;

interface Subscribed {
  take: Taker;
  schema: Schema | undefined;
}

export interface Listener {
  /** Who takes the messages of a topic; without anybody they need not come. */
  taker(topic: string): Taker | undefined;
  /** The way is open, with what the server says of itself. */
  opened(info: Info): void;
  /** It is closed. */
  closed(): void;
  /** Which services there are now. */
  services(names: string[]): void;
  status(level: number, text: string, id: string | undefined): void;
  playback(state: Playback): void;
}

type Answer = { [field: string]: any };
interface Waiting {
  resolve(answer: Answer): void;
  reject(error: Error): void;
  timer: number;
}

const PROTOCOL = "foxglove.websocket.v1";
const ENCODE = new TextEncoder();
const DECODE = new TextDecoder();

/** A client that comes back by itself. */
export class Client {
  private socket: WebSocket | undefined;
  private readonly channels = new Map<number, Subscribed>();
  private readonly offered = new Map<string, Offered>();
  private readonly waiting = new Map<number, Waiting>();
  private calls = 0;
  private own = new Map<string, number>();
  private session = "";
  private again = 250;
  private ended = false;

  constructor(
    private readonly listener: Listener,
    private readonly token: string | undefined,
  ) {}

  connect(): void {
    const protocols = [PROTOCOL];
    if (this.token) protocols.push(`token.${this.token}`);
    const socket = new WebSocket(`ws://${location.host}/`, protocols);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    // A server that vanished without a word says nothing more.
    let heard = performance.now();
    const watch = setInterval(() => {
      if (performance.now() - heard > 5000) socket.close();
    }, 1000);
    socket.onmessage = (event) => {
      heard = performance.now();
      try {
        if (typeof event.data === "string") this.text(JSON.parse(event.data));
        else this.bytes(new DataView(event.data));
      } catch (error) {
        console.warn("a message was left out", error);
      }
    };
    socket.onclose = () => {
      clearInterval(watch);
      this.channels.clear();
      this.offered.clear();
      this.own.clear();
      for (const one of this.waiting.values()) {
        clearTimeout(one.timer);
        one.reject(new Error("the connection is lost"));
      }
      this.waiting.clear();
      if (this.ended) return;
      this.listener.closed();
      setTimeout(() => this.connect(), this.again);
      this.again = Math.min(this.again * 1.5, 2000);
    };
  }

  get isOpen(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  has(service: string): boolean {
    return this.offered.has(service);
  }

  /** Calls a service; rejects with the server's reason. */
  call(service: string, request: object, patience = 8000): Promise<Answer> {
    const offered = this.offered.get(service);
    if (!this.isOpen) return Promise.reject(new Error("the connection is lost"));
    if (!offered) return Promise.reject(new Error(`there is no service ${service}`));
    const call = (this.calls = (this.calls + 1) >>> 0);
    const payload = ENCODE.encode(JSON.stringify(request));
    const bytes = new Uint8Array(17 + payload.length);
    const view = new DataView(bytes.buffer);
    view.setUint8(0, 2);
    view.setUint32(1, offered.id, true);
    view.setUint32(5, call, true);
    view.setUint32(9, 4, true);
    bytes.set(ENCODE.encode("json"), 13);
    bytes.set(payload, 17);
    return new Promise((resolve, reject) => {
      const timer = window.setTimeout(() => {
        this.waiting.delete(call);
        reject(new Error("no answer came"));
      }, patience);
      this.waiting.set(call, { resolve, reject, timer });
      this.socket!.send(bytes);
    });
  }

  /** Sends a message; nothing while the way is closed or crowded. */
  publish(topic: string, message: object): boolean {
    if (!this.isOpen || this.socket!.bufferedAmount > 4096) return false;
    let id = this.own.get(topic);
    if (id === undefined) {
      id = this.own.size + 1;
      this.own.set(topic, id);
      const channel = { id, topic, encoding: "json", schemaName: "view.Message" };
      this.say({ op: "advertise", channels: [channel] });
    }
    const payload = ENCODE.encode(JSON.stringify(message));
    const bytes = new Uint8Array(5 + payload.length);
    bytes[0] = 1;
    new DataView(bytes.buffer).setUint32(1, id, true);
    bytes.set(payload, 5);
    this.socket!.send(bytes);
    return true;
  }

  /** Plays, pauses or seeks a recording. */
  play(play: boolean, speed: number, seek?: number): void {
    if (!this.isOpen) return;
    const bytes = new Uint8Array(20);
    const view = new DataView(bytes.buffer);
    view.setUint8(0, 3);
    view.setUint8(1, play ? 0 : 1);
    view.setFloat32(2, speed, true);
    view.setUint8(6, seek === undefined ? 0 : 1);
    view.setBigUint64(7, BigInt(Math.max(0, Math.round(seek ?? 0))), true);
    view.setUint32(15, 1, true);
    bytes[19] = 112;
    this.socket!.send(bytes);
  }

  private say(what: object): void {
    this.socket!.send(JSON.stringify(what));
  }

  private text(said: any): void {
    switch (said.op) {
      case "serverInfo": {
        this.again = 250;
        const stamp = (at: any) => (at ? at.sec * 1e9 + at.nsec : undefined);
        const info: Info = {
          name: String(said.name),
          access: String(said.metadata?.access ?? "full"),
          files: String(said.metadata?.files ?? ""),
          another: this.session !== "" && this.session !== said.sessionId,
        };
        this.session = String(said.sessionId);
        const start = stamp(said.dataStartTime);
        const end = stamp(said.dataEndTime);
        if (start !== undefined) info.start = start;
        if (end !== undefined) info.end = end;
        this.listener.opened(info);
        break;
      }
      case "advertise": {
        const subscriptions = [];
        for (const channel of said.channels as Channel[]) {
          const take = this.listener.taker(channel.topic);
          if (!take) continue;
          const schema = channel.encoding === "cdr" ? readSchema(channel.schema) : undefined;
          this.channels.set(channel.id, { take, schema });
          subscriptions.push({ id: channel.id, channelId: channel.id });
        }
        if (subscriptions.length) this.say({ op: "subscribe", subscriptions });
        break;
      }
      case "advertiseServices":
        for (const one of said.services as Offered[]) this.offered.set(one.name, one);
        this.listener.services([...this.offered.keys()]);
        break;
      case "serviceCallFailure":
        this.settle(said.callId, (one) => one.reject(new Error(String(said.message))));
        break;
      case "status":
        this.listener.status(said.level, String(said.message), said.id);
        break;
    }
  }

  private settle(call: number, how: (one: Waiting) => void): void {
    const one = this.waiting.get(call);
    if (!one) return;
    this.waiting.delete(call);
    clearTimeout(one.timer);
    how(one);
  }

  private bytes(view: DataView): void {
    switch (view.getUint8(0)) {
      case 1: {
        const known = this.channels.get(view.getUint32(1, true));
        if (!known) return;
        const payload = new DataView(view.buffer, 13);
        const message = known.schema
          ? readMessage(known.schema, payload)
          : JSON.parse(DECODE.decode(payload));
        known.take(message);
        break;
      }
      case 3: {
        const call = view.getUint32(5, true);
        const start = 13 + view.getUint32(9, true);
        const answer = JSON.parse(DECODE.decode(new Uint8Array(view.buffer, start)));
        this.settle(call, (one) => one.resolve(answer));
        break;
      }
      case 5:
        this.listener.playback({
          status: view.getUint8(1),
          now: Number(view.getBigUint64(2, true)),
          speed: view.getFloat32(10, true),
          sought: view.getUint8(14) !== 0,
        });
        break;
    }
  }
}
