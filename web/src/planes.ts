// Friction against velocity and against position.

import { colour, round } from "./curves";

/** Room for the numbers beside a plane [px]. */
const LEFT = 56;
const BOTTOM = 34;
const EDGE = 8;

/** A canvas with two axes, drawn sharp on any screen. */
class Sheet {
  readonly context: CanvasRenderingContext2D;
  width = 300;
  height = 240;

  constructor(readonly canvas: HTMLCanvasElement) {
    this.context = canvas.getContext("2d")!;
    new ResizeObserver(() => this.fit()).observe(canvas);
    this.fit();
  }

  private fit(): void {
    const ratio = window.devicePixelRatio || 1;
    this.width = Math.max(120, this.canvas.clientWidth);
    this.height = Math.max(120, this.canvas.clientHeight);
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  /** Clears, draws the axes, and returns what places a point. */
  axes(
    [xLow, xHigh]: [number, number],
    [yLow, yHigh]: [number, number],
    xLabel: string,
    yLabel: string,
  ): [(x: number) => number, (y: number) => number] {
    const { context: c, width, height } = this;
    const x = (value: number) =>
      LEFT + ((value - xLow) / (xHigh - xLow)) * (width - LEFT - EDGE);
    const y = (value: number) =>
      height - BOTTOM - ((value - yLow) / (yHigh - yLow)) * (height - BOTTOM - EDGE);
    c.clearRect(0, 0, width, height);
    c.font = "12px system-ui, sans-serif";
    c.lineWidth = 1;
    c.fillStyle = colour("text");
    c.strokeStyle = colour("grid");
    c.beginPath();
    c.textAlign = "center";
    c.textBaseline = "top";
    for (const tick of ticks(xLow, xHigh)) {
      c.moveTo(x(tick), EDGE);
      c.lineTo(x(tick), height - BOTTOM);
      c.fillText(round(tick), x(tick), height - BOTTOM + 3);
    }
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (const tick of ticks(yLow, yHigh)) {
      c.moveTo(LEFT, y(tick));
      c.lineTo(width - EDGE, y(tick));
      c.fillText(round(tick), LEFT - 4, y(tick));
    }
    c.stroke();
    c.textAlign = "center";
    c.textBaseline = "bottom";
    c.fillText(xLabel, (LEFT + width) / 2, height - 1);
    c.textAlign = "left";
    c.textBaseline = "top";
    c.fillText(yLabel, LEFT + 4, EDGE);
    return [x, y];
  }

  inside(draw: () => void): void {
    const { context: c, width, height } = this;
    c.save();
    c.beginPath();
    c.rect(LEFT, EDGE, width - LEFT - EDGE, height - BOTTOM - EDGE);
    c.clip();
    draw();
    c.restore();
  }
}

function ticks(low: number, high: number): number[] {
  const rough = (high - low) / 4;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((times) => times * power).find((one) => one >= rough) ?? rough;
  const all: number[] = [];
  for (let tick = Math.ceil(low / step); tick * step <= high; tick++) all.push(tick * step);
  return all;
}

const CELLS = 192;

/** Friction against velocity: cells that fill up, with the model's curve over them. */
export class Stribeck {
  private readonly sheet: Sheet;
  private counts = new Uint32Array(CELLS * CELLS);
  private most = 0;
  /** Half the width of the plane [rad/s] and [N m]. */
  private xHalf = 0.05;
  private yHalf = 0.01;
  points = 0;
  curve: { velocity: number[]; torque: number[]; model: string } | undefined;

  constructor(canvas: HTMLCanvasElement) {
    this.sheet = new Sheet(canvas);
  }

  clear(): void {
    this.counts.fill(0);
    [this.most, this.points, this.xHalf, this.yHalf] = [0, 0, 0.05, 0.01];
  }

  add(velocity: number, torque: number): void {
    if (!Number.isFinite(velocity) || !Number.isFinite(torque)) return;
    while (Math.abs(velocity) >= this.xHalf && this.xHalf < 1e6) this.widen("x");
    while (Math.abs(torque) >= this.yHalf && this.yHalf < 1e6) this.widen("y");
    const column = Math.floor((velocity / this.xHalf + 1) * (CELLS / 2));
    const row = Math.floor((torque / this.yHalf + 1) * (CELLS / 2));
    if (column < 0 || row < 0 || column >= CELLS || row >= CELLS) return;
    const count = ++this.counts[row * CELLS + column]!;
    this.most = Math.max(this.most, count);
    this.points++;
  }

  /** Twice as wide: two cells become one. */
  private widen(which: "x" | "y"): void {
    const old = this.counts;
    this.counts = new Uint32Array(CELLS * CELLS);
    const half = CELLS / 2;
    const to = (at: number) => Math.floor((at - half) / 2) + half;
    for (let row = 0; row < CELLS; row++) {
      for (let column = 0; column < CELLS; column++) {
        const count = old[row * CELLS + column]!;
        if (!count) continue;
        const [r, c] = which === "x" ? [row, to(column)] : [to(row), column];
        const now = (this.counts[r * CELLS + c]! += count);
        this.most = Math.max(this.most, now);
      }
    }
    if (which === "x") this.xHalf *= 2;
    else this.yHalf *= 2;
  }

  draw(): void {
    const { sheet } = this;
    const [x, y] = sheet.axes(
      [-this.xHalf, this.xHalf], [-this.yHalf, this.yHalf], "velocity [rad/s]", "friction [N m]",
    );
    const c = sheet.context;
    sheet.inside(() => {
      c.fillStyle = colour("measured");
      const [cellX, cellY] = [(2 * this.xHalf) / CELLS, (2 * this.yHalf) / CELLS];
      const [w, h] = [Math.max(1.5, x(cellX) - x(0)), Math.max(1.5, y(0) - y(cellY))];
      const full = Math.log1p(this.most);
      for (let row = 0; row < CELLS; row++) {
        for (let column = 0; column < CELLS; column++) {
          const count = this.counts[row * CELLS + column]!;
          if (!count) continue;
          c.globalAlpha = 0.25 + (0.75 * Math.log1p(count)) / full;
          c.fillRect(x(column * cellX - this.xHalf), y((row + 1) * cellY - this.yHalf), w, h);
        }
      }
      c.globalAlpha = 1;
      if (!this.curve) return;
      c.strokeStyle = colour("estimated");
      c.lineWidth = 2;
      c.beginPath();
      this.curve.velocity.forEach((velocity, at) => {
        c.lineTo(x(velocity), y(this.curve!.torque[at]!));
      });
      c.stroke();
    });
  }
}

/** Points of the hysteresis plane that are drawn. */
const PATH = 4000;

/** Friction against position: the last stretch of the way. */
export class Hysteresis {
  private readonly sheet: Sheet;
  private path: { x: number; y: number }[] = [];

  constructor(canvas: HTMLCanvasElement) {
    this.sheet = new Sheet(canvas);
  }

  clear(): void {
    this.path = [];
  }

  add(x: number, y: number): void {
    if (!Number.isFinite(x) || !Number.isFinite(y)) return;
    this.path.push({ x, y });
    if (this.path.length > 2 * PATH) this.path.splice(0, PATH);
  }

  draw(): void {
    const path = this.path.slice(-PATH);
    const [x, y] = this.sheet.axes(
      extent(path.map((one) => one.x), 1e-4), extent(path.map((one) => one.y), 1e-3),
      "position [rad]", "friction [N m]",
    );
    const c = this.sheet.context;
    this.sheet.inside(() => {
      c.strokeStyle = colour("measured");
      c.lineWidth = 1.2;
      c.beginPath();
      for (const one of path) c.lineTo(x(one.x), y(one.y));
      c.stroke();
    });
  }
}

function extent(values: number[], least: number): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) [low, high] = [Math.min(low, value), Math.max(high, value)];
  if (low > high) return [-least, least];
  const room = Math.max((high - low) * 0.06, least);
  return [low - room, high + room];
}
