// Curves against time.

import uPlot from "uplot";
import { Column, Ring } from "./ring";

export interface Curve {
  column: Column;
  label: string;
  /** Name of a colour in app.css. */
  colour: string;
  dash?: number[];
}

/** Height of a plot [px]. */
const HEIGHT = 170;

export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export class Curves {
  private plot: uPlot | undefined;
  private visible = true;
  /** Lines across the plot, as limits; [V] or what the plot is in. */
  limits: number[] = [];

  constructor(
    private readonly place: HTMLElement,
    private readonly unit: string,
    private readonly curves: readonly Curve[],
  ) {
    new IntersectionObserver((entries) => {
      this.visible = entries.some((entry) => entry.isIntersecting);
    }).observe(place);
    new ResizeObserver(() => {
      this.plot?.setSize({ width: this.width(), height: HEIGHT });
    }).observe(place);
    this.make();
  }

  private width(): number {
    return Math.max(160, Math.floor(this.place.clientWidth));
  }

  /** Makes the plot anew, with the colours of now. */
  make(): void {
    this.plot?.destroy();
    const axis = { stroke: colour("text"), grid: { stroke: colour("grid"), width: 1 } };
    const options: uPlot.Options = {
      width: this.width(),
      height: HEIGHT,
      pxAlign: false,
      cursor: { show: false },
      legend: { show: false },
      scales: {
        x: { time: false },
        y: { range: (_plot, low, high) => range(low, high) },
      },
      axes: [
        { ...axis, values: (_plot, ticks) => ticks.map((tick) => `${round(tick)} s`) },
        { ...axis, size: 62, values: (_plot, ticks) => ticks.map(round) },
      ],
      series: [
        {},
        ...this.curves.map((one) => ({
          label: one.label,
          stroke: colour(one.colour),
          width: 1.5,
          ...(one.dash ? { dash: one.dash } : {}),
          points: { show: false },
        })),
      ],
      hooks: { draw: [(plot) => this.drawLimits(plot)] },
    };
    const empty: uPlot.AlignedData = [[], ...this.curves.map(() => [])];
    this.plot = new uPlot(options, empty, this.place);
    this.plot.root.querySelector("canvas")?.setAttribute("aria-hidden", "true");
  }

  private drawLimits(plot: uPlot): void {
    for (const limit of this.limits) {
      const y = plot.valToPos(limit, "y", true);
      const { left, top, width, height } = plot.bbox;
      if (!(y >= top && y <= top + height)) continue;
      plot.ctx.save();
      plot.ctx.strokeStyle = colour("bad");
      plot.ctx.setLineDash([6, 4]);
      plot.ctx.beginPath();
      plot.ctx.moveTo(left, y);
      plot.ctx.lineTo(left + width, y);
      plot.ctx.stroke();
      plot.ctx.restore();
    }
  }

  /** Draws the time from `to - span` to `to` [s]; times are told from `to` on. */
  draw(ring: Ring, to: number, span: number): void {
    if (!this.plot || !this.visible) return;
    const names = this.curves.map((one) => one.column);
    const data = ring.extremes(names, to - span, to + 1e-9, this.width());
    for (let at = 0; at < data[0].length; at++) data[0][at]! -= to;
    this.plot.setData(data as uPlot.AlignedData, false);
    this.plot.batch(() => {
      this.plot!.setScale("x", { min: -span, max: 0 });
    });
  }

  /** The last values, for those who do not see the plot. */
  words(ring: Ring): string {
    if (!ring.count) return "no data";
    const last = (name: Column) => {
      for (let row = ring.count - 1; row >= Math.max(ring.first, ring.count - 50); row--) {
        const value = ring.get(row, name);
        if (Number.isFinite(value)) return `${value.toPrecision(3)} ${this.unit}`;
      }
      return "none";
    };
    return this.curves.map((one) => `${one.label} ${last(one.column)}`).join(", ");
  }
}

function range(low: number, high: number): [number, number] {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [-1, 1];
  const room = Math.max((high - low) * 0.08, Math.abs(high) * 1e-6, 1e-6);
  return [low - room, high + room];
}

export function round(value: number): string {
  return String(Number(value.toPrecision(4)));
}
