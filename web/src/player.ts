// A recording: play, pause, place and speed.

import { Client, Playback } from "./client";
import { by, write } from "./dom";

const PLAYING = 0;
const ENDED = 3;

export class Player {
  private start = 0;
  private end = 0;
  private state: Playback | undefined;
  private dragging = false;

  constructor(private readonly client: () => Client) {
    const seek = by<HTMLInputElement>("seek");
    by("play").addEventListener("click", () => {
      const plays = this.state?.status === PLAYING;
      const ended = this.state?.status === ENDED;
      this.client().play(!plays, this.speed(), ended ? this.start : undefined);
    });
    by("speed").addEventListener("change", () => {
      this.client().play(this.state?.status === PLAYING, this.speed());
    });
    seek.addEventListener("input", () => {
      this.dragging = true;
      this.tell(this.start + seek.valueAsNumber * 1e9);
    });
    seek.addEventListener("change", () => {
      this.dragging = false;
      const place = this.start + seek.valueAsNumber * 1e9;
      this.client().play(this.state?.status === PLAYING, this.speed(), place);
    });
  }

  range(start: number | undefined, end: number | undefined): void {
    by("player").hidden = start === undefined || end === undefined;
    if (start === undefined || end === undefined) return;
    [this.start, this.end] = [start, end];
    by<HTMLInputElement>("seek").max = String((end - start) / 1e9);
  }

  take(state: Playback): void {
    this.state = state;
    write(by("play"), state.status === PLAYING ? "Pause" : "Play");
    if (this.dragging) return;
    by<HTMLInputElement>("seek").value = String((state.now - this.start) / 1e9);
    this.tell(state.now);
  }

  private tell(now: number): void {
    const [at, length] = [(now - this.start) / 1e9, (this.end - this.start) / 1e9];
    write(by("seek-said"), `${at.toFixed(1)} of ${length.toFixed(1)} s`);
  }

  private speed(): number {
    return Number(by<HTMLSelectElement>("speed").value);
  }
}
