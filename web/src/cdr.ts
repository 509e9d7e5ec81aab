// Messages as CDR, read by their ros2msg schema.

export type Message = { [field: string]: Field };
export type Field = number | bigint | boolean | string | Message | Field[] | Float64Array;

interface Part {
  name: string;
  /** A built-in type, or the name of another definition. */
  type: string;
  /** Not an array, one of any length, or one of so many. */
  array: "no" | "any" | number;
}

export type Schema = Map<string, Part[]>;

const BUILT_IN = new Set([
  "bool", "byte", "char", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64",
  "float32", "float64", "string",
]);

/** Reads a schema; its own type stands under "". */
export function readSchema(text: string): Schema {
  const schema: Schema = new Map();
  const parts = text.split(/^={20,}$/m);
  parts.forEach((part, at) => {
    const lines = part.split("\n");
    let name = "";
    if (at > 0) {
      const head = lines.findIndex((line) => line.startsWith("MSG:"));
      name = lines[head]?.slice(4).trim() ?? "";
      lines.splice(0, head + 1);
    }
    schema.set(name, lines.flatMap(readLine));
  });
  return schema;
}

function readLine(line: string): Part[] {
  const bare = line.replace(/#.*$/, "").trim();
  // A constant has an equals sign behind its name.
  const found = /^([\w/]+)(?:<=\d+)?(\[(?:<=)?(\d*)\])?\s+(\w+)\s*(=)?/.exec(bare);
  if (!found || found[5]) return [];
  const bounded = found[2]?.includes("<=");
  const array = !found[2] ? "no" : found[3] && !bounded ? Number(found[3]) : "any";
  return [{ name: found[4]!, type: found[1]!, array }];
}

const TEXT = new TextDecoder();

class Reader {
  private at = 4;
  private readonly little: boolean;
  constructor(private readonly view: DataView) {
    this.little = (view.getUint8(1) & 1) === 1;
  }

  private place(size: number): number {
    // Offsets count from behind the header of four bytes.
    const off = (this.at - 4) % size;
    if (off) this.at += size - off;
    const place = this.at;
    this.at += size;
    return place;
  }

  read(type: string): Field {
    switch (type) {
      case "bool": return this.view.getUint8(this.place(1)) !== 0;
      case "byte": case "char": case "uint8": return this.view.getUint8(this.place(1));
      case "int8": return this.view.getInt8(this.place(1));
      case "int16": return this.view.getInt16(this.place(2), this.little);
      case "uint16": return this.view.getUint16(this.place(2), this.little);
      case "int32": return this.view.getInt32(this.place(4), this.little);
      case "uint32": return this.length();
      case "int64": return this.view.getBigInt64(this.place(8), this.little);
      case "uint64": return this.view.getBigUint64(this.place(8), this.little);
      case "float32": return this.view.getFloat32(this.place(4), this.little);
      case "float64": return this.view.getFloat64(this.place(8), this.little);
      default: {
        const length = this.length();
        const start = this.view.byteOffset + this.at;
        if (this.at + length > this.view.byteLength) throw new RangeError("the message is cut");
        const bytes = new Uint8Array(this.view.buffer, start, Math.max(0, length - 1));
        this.at += length;
        return TEXT.decode(bytes);
      }
    }
  }

  length(): number {
    return this.view.getUint32(this.place(4), this.little);
  }

  left(): number {
    return this.view.byteLength - this.at;
  }
}

/** Reads a message. Throws what is no message of the schema. */
export function readMessage(schema: Schema, bytes: DataView): Message {
  return readParts(schema, "", "", new Reader(bytes));
}

function readParts(schema: Schema, name: string, within: string, reader: Reader): Message {
  const parts = schema.get(name) ?? schema.get(`${within}/${name}`);
  if (!parts) throw new RangeError(`no type ${name}`);
  const here = name.includes("/") ? name.split("/")[0]! : within;
  const message: Message = {};
  for (const part of parts) {
    const one = (): Field =>
      BUILT_IN.has(part.type)
        ? reader.read(part.type)
        : readParts(schema, find(schema, part.type, here), here, reader);
    if (part.array === "no") {
      message[part.name] = one();
      continue;
    }
    const count = part.array === "any" ? reader.length() : part.array;
    if (count > reader.left()) throw new RangeError("the message is cut");
    const all: Field[] = [];
    for (let at = 0; at < count; at++) all.push(one());
    message[part.name] = all;
  }
  return message;
}

/** A type is named with its package, with `msg` between, or alone within its own package. */
function find(schema: Schema, type: string, within: string): string {
  const short = type.replace("/msg/", "/");
  if (schema.has(short)) return short;
  if (within && schema.has(`${within}/${short}`)) return `${within}/${short}`;
  for (const known of schema.keys()) if (known.endsWith(`/${short}`)) return known;
  throw new RangeError(`no type ${type}`);
}
