// The last cycles, one row each, and what is drawn of them.

/** What a cycle has; what did not come is no number. */
export const COLUMNS = [
  "position", "velocity", "torque", "asked", "applied", "reference", "feedback", "error",
  "estimate", "residual", "period",
] as const;
export type Column = (typeof COLUMNS)[number];

/** Cycles that are kept: two minutes at 1 kHz. */
const ROWS = 1 << 17;
/** How far back a message looks for its cycle. */
const LATE = 256;

export class Ring {
  readonly time = new Float64Array(ROWS);
  private readonly columns = new Map<Column, Float64Array>();
  /** Rows that were ever begun. */
  count = 0;

  constructor() {
    for (const name of COLUMNS) this.columns.set(name, new Float64Array(ROWS).fill(NaN));
  }

  clear(): void {
    this.count = 0;
  }

  /** Time of the last row [s]. */
  get last(): number {
    return this.count ? this.time[(this.count - 1) % ROWS]! : NaN;
  }

  /** The first row that is kept. */
  get first(): number {
    return Math.max(0, this.count - ROWS);
  }

  /** The row of a time; a new one if it is later than all. -1 for one that is not kept. */
  row(time: number): number {
    if (this.count === 0 || time > this.last) {
      const row = this.count++;
      this.time[row % ROWS] = time;
      for (const column of this.columns.values()) column[row % ROWS] = NaN;
      return row;
    }
    const until = Math.max(this.first, this.count - LATE);
    for (let row = this.count - 1; row >= until; row--) {
      if (this.time[row % ROWS] === time) return row;
    }
    return -1;
  }

  set(row: number, name: Column, value: number): void {
    if (row >= 0) this.columns.get(name)![row % ROWS] = value;
  }

  get(row: number, name: Column): number {
    return this.columns.get(name)![row % ROWS]!;
  }

  at(row: number): number {
    return this.time[row % ROWS]!;
  }

  /** The first row that is not before a time. */
  from(time: number): number {
    let [low, high] = [this.first, this.count];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.at(middle) < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /**
   * Columns between two times, decimated by extremes: of each of `buckets` stretches the lowest
   * and the highest value of every column, in the order in which they came. No peak is lost.
   */
  extremes(names: readonly Column[], from: number, to: number, buckets: number): Drawn {
    const [begin, end] = [this.from(from), this.from(to)];
    const columns = names.map((name) => this.columns.get(name)!);
    if (end - begin <= 2 * buckets) {
      const x: number[] = [];
      const ys: Values[] = names.map(() => []);
      for (let row = begin; row < end; row++) {
        x.push(this.at(row));
        columns.forEach((column, at) => ys[at]!.push(number(column[row % ROWS]!)));
      }
      return [x, ...ys];
    }
    const x: number[] = [];
    const ys: Values[] = names.map(() => []);
    const width = (to - from) / buckets;
    let row = begin;
    while (row < end) {
      const bucket = Math.floor((this.at(row) - from) / width);
      const until = from + (bucket + 1) * width;
      const start = row;
      do row++;
      while (row < end && this.at(row) < until);
      x.push(from + bucket * width, from + (bucket + 0.5) * width);
      columns.forEach((column, at) => {
        let [low, high, lowAt, highAt] = [Infinity, -Infinity, 0, 0];
        for (let inside = start; inside < row; inside++) {
          const value = column[inside % ROWS]!;
          if (value < low) [low, lowAt] = [value, inside];
          if (value > high) [high, highAt] = [value, inside];
        }
        const values = ys[at]!;
        if (low > high) values.push(null, null);
        else if (lowAt <= highAt) values.push(low, high);
        else values.push(high, low);
      });
    }
    return [x, ...ys];
  }
}

type Values = (number | null)[];
export type Drawn = [number[], ...Values[]];

function number(value: number): number | null {
  return Number.isFinite(value) ? value : null;
}
