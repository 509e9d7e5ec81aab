// Numbers and times as a person reads them.

/** A length of time. */
export function time(seconds: number): string {
  if (!Number.isFinite(seconds)) return "an unknown time";
  if (seconds < 90) return `${Math.round(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}

/** A number to three figures. */
export function short(value: number): string {
  return String(Number(value.toPrecision(3)));
}
