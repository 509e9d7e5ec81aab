// Small charts of few points, as SVG: sharp at any size, and with a text for those who do not see.

import { short } from "./words";

export interface Line {
  name: string;
  /** Name of a class in app.css that gives the colour. */
  kind: string;
  points: [number, number][];
  /** Points without a line between them. */
  dots?: boolean;
  /** A height that is to be reached, drawn across. */
  goal?: number | undefined;
}

export interface Axes {
  x: string;
  y: string;
  logX?: boolean;
  logY?: boolean;
}

const NS = "http://www.w3.org/2000/svg";
const [WIDTH, HEIGHT] = [480, 260];
/** Room for numbers and names [px]. */
const [LEFT, RIGHT, TOP, BOTTOM] = [58, 64, 22, 38];

export function chart(place: SVGSVGElement, axes: Axes, lines: Line[]): void {
  place.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
  place.replaceChildren();
  const all = lines.flatMap((line) => line.points);
  const xs = extent(all.map(([x]) => x), axes.logX === true);
  const goals = lines.flatMap((line) => (line.goal === undefined ? [] : [line.goal]));
  const ys = extent([...all.map(([, y]) => y), ...goals], axes.logY === true);
  if (!xs || !ys) {
    text(place, WIDTH / 2, HEIGHT / 2, "nothing yet", "middle");
    return;
  }
  const x = scale(xs, axes.logX === true, [LEFT, WIDTH - RIGHT]);
  const y = scale(ys, axes.logY === true, [HEIGHT - BOTTOM, TOP]);
  for (const tick of ticks(xs, axes.logX === true)) {
    segment(place, "grid", x(tick), TOP, x(tick), HEIGHT - BOTTOM);
    text(place, x(tick), HEIGHT - BOTTOM + 14, short(tick), "middle");
  }
  for (const tick of ticks(ys, axes.logY === true)) {
    segment(place, "grid", LEFT, y(tick), WIDTH - RIGHT, y(tick));
    text(place, LEFT - 5, y(tick) + 4, short(tick), "end");
  }
  text(place, (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 6, axes.x, "middle");
  text(place, 4, 13, axes.y, "start");
  const named: number[] = [];
  for (const line of lines) {
    if (line.goal !== undefined) {
      const goal = segment(place, `goal ${line.kind}`, LEFT, y(line.goal), WIDTH - RIGHT, y(line.goal));
      goal.append(title(`${line.name} is wanted to ${short(line.goal)}`));
    }
    if (line.dots) {
      for (const [at, value] of line.points) {
        add(place, "circle", { class: line.kind, cx: x(at), cy: y(value), r: 3 });
      }
      continue;
    }
    if (!line.points.length) continue;
    const path = line.points.map(([at, value]) => `${x(at).toFixed(1)},${y(value).toFixed(1)}`);
    add(place, "polyline", { class: line.kind, points: path.join(" ") });
    // The name stands at the end of the line, and not over another.
    let height = y(line.points.at(-1)![1]) + 4;
    while (named.some((other) => Math.abs(other - height) < 14)) height += 14;
    named.push(height);
    text(place, WIDTH - RIGHT + 4, Math.min(height, HEIGHT - 4), line.name, "start", line.kind);
  }
}

function extent(values: number[], log: boolean): [number, number] | undefined {
  const good = values.filter((value) => Number.isFinite(value) && (!log || value > 0));
  if (!good.length) return undefined;
  const [low, high] = [Math.min(...good), Math.max(...good)];
  if (log) return [low / 1.15, high * 1.15];
  const room = Math.max((high - low) * 0.08, Math.abs(high) * 1e-3, 1e-9);
  return [low - room, high + room];
}

function scale([low, high]: [number, number], log: boolean, [from, to]: [number, number]) {
  const of = (value: number) => (log ? Math.log(Math.max(value, 1e-300)) : value);
  const [a, b] = [of(low), of(high)];
  return (value: number) => from + ((of(value) - a) / (b - a)) * (to - from);
}

function ticks([low, high]: [number, number], log: boolean): number[] {
  const all: number[] = [];
  if (log) {
    const steps = high / low > 200 ? [1] : high / low > 12 ? [1, 3] : [1, 1.5, 2, 3, 5, 7];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
      for (const step of steps) all.push(step * 10 ** power);
    }
    return all.filter((tick) => tick >= low && tick <= high);
  }
  const rough = (high - low) / 4;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((times) => times * power).find((one) => one >= rough) ?? rough;
  for (let tick = Math.ceil(low / step); tick * step <= high; tick++) all.push(tick * step);
  return all;
}

function add(place: Element, tag: string, attributes: Record<string, string | number>): SVGElement {
  const element = document.createElementNS(NS, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  place.append(element);
  return element;
}

function segment(place: Element, kind: string, x1: number, y1: number, x2: number, y2: number) {
  return add(place, "line", { class: kind, x1, y1, x2, y2 });
}

function text(
  place: Element, x: number, y: number, what: string, anchor: string, kind = "",
): void {
  add(place, "text", { x, y, "text-anchor": anchor, class: kind }).textContent = what;
}

function title(what: string): SVGElement {
  const element = document.createElementNS(NS, "title");
  element.textContent = what;
  return element;
}
