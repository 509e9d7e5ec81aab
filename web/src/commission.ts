// A commission: what it does and what comes next, the intervals as they shrink, consent, and what
// came of it.

import { chart, Line } from "./chart";
import { Client } from "./client";
import { by, make, write } from "./dom";
import { Runs } from "./runs";
import { short, time } from "./words";

interface Ranged {
  value: number;
  low: number | null;
  high: number | null;
}

interface Curve {
  f_s: Ranged;
  f_c: Ranged;
  v_s: Ranged;
  slope: Ranged;
  dips: boolean;
}

interface Standing {
  stage: string | null;
  folder: string;
  doing: string;
  done: { stage: string; seconds: number; found: [string, string][] }[];
  used: number;
  left: number;
  wanted: [string, number][];
  narrowed: { blocks: number; parameters: [string, Ranged][] }[];
  curve: Curve | null;
  points: [number, number][];
  lines: string[];
  worth: string | null;
}

interface Paper {
  phase: "before" | "asks" | "runs" | "done" | "ended";
  question: string | null;
  believed: [string, string][];
  why: string | null;
  hint: string;
  standing: Standing;
}

/** The stages in their order, and what each finds. */
const STAGES: [string, string][] = [
  ["meet", "signs, zeros, noise, and the voltages that just move the shaft"],
  ["drive", "gain, time constant and delay"],
  ["friction", "the curve over speed, block by block"],
  ["model", "which curve predicts a block that was kept back"],
  ["control", "linear gains, and what is fed forward"],
  ["proof", "before and after in turns, with 95 % intervals"],
  ["hand-over", "parameters and report"],
];
const KINDS: Record<string, string> = {
  f_c: "measured", f_s: "estimated", v_s: "third", slope: "fourth",
};
const UNITS: Record<string, string> = { f_c: "V", f_s: "V", v_s: "rad/s", slope: "V s/rad" };

export class Commission {
  private paper: Paper | undefined;
  private drawn = "";
  private stop = "";
  private consent = "";
  private asked = "";
  mayChange = true;

  constructor(
    private readonly client: () => Client,
    private readonly runs: Runs,
  ) {
    by("commission-stop").addEventListener("click", () => void this.end());
    by("consent-here").addEventListener("change", () => this.enable());
    by("consent-yes").addEventListener("click", () => void this.answer("yes"));
    by("consent-no").addEventListener("click", () => void this.answer("no"));
  }

  services(names: string[]): void {
    this.stop = names.find((name) => name.endsWith("/experiment_runner/abort")) ?? "";
    this.consent = names.find((name) => name === "/commission/consent") ?? "";
    this.enable();
  }

  /** Another program: what is shown is of the one before. */
  clear(): void {
    this.paper = undefined;
    this.drawn = "";
    by("commission").hidden = true;
  }

  enable(): void {
    const works = this.client().isOpen && this.mayChange;
    const goes = this.paper?.phase === "runs" || this.paper?.phase === "asks";
    by<HTMLButtonElement>("commission-stop").disabled = !works || !goes || !this.stop;
    const asks = works && this.paper?.phase === "asks" && this.consent !== "";
    const here = by<HTMLInputElement>("consent-here");
    here.disabled = !asks;
    by<HTMLButtonElement>("consent-yes").disabled = !asks || !here.checked;
    by<HTMLButtonElement>("consent-no").disabled = !asks;
  }

  take(paper: Paper): void {
    this.paper = paper;
    by("commission").hidden = false;
    this.showConsent(paper);
    this.showNow(paper);
    this.showStages(paper);
    this.showFriction(paper.standing);
    this.showEnd(paper);
    this.enable();
  }

  private showConsent(paper: Paper): void {
    const asks = paper.phase === "asks";
    by("consent").hidden = !asks;
    if (paper.question !== this.asked) {
      // Who said yes to another question has not said it to this one.
      this.asked = paper.question ?? "";
      by<HTMLInputElement>("consent-here").checked = false;
      write(by("consent-said"), this.mayChange ? "" : "This viewer may only look.");
    }
    const facts = paper.believed.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]);
    const place = by("believed");
    if (place.childElementCount !== facts.length) place.replaceChildren(...facts);
    by("believed-all").hidden = facts.length === 0;
    if (asks) by<HTMLDetailsElement>("believed-all").open = true;
  }

  private showNow({ phase, standing }: Paper): void {
    const said = {
      before: "It looks at the rig. Nothing moves.",
      asks: "It waits for consent. Nothing moves.",
      runs: standing.stage ? `${standing.stage}: ${standing.doing || "it begins"}` : "it goes on",
      done: "Done.",
      ended: "It ended. The motor is at zero volts.",
    }[phase];
    write(by("commission-now"), said);
    // Where no node tells of the rig.
    if (this.consent) {
      const rig = by("rig");
      rig.className = "badge";
      write(rig, phase === "runs" ? "rig: driven" : "rig: zero volts");
    }
    const bar = by<HTMLProgressElement>("commission-progress");
    const all = standing.used + standing.left;
    bar.value = phase === "done" ? 1 : all > 0 ? standing.used / all : 0;
    const left = phase === "runs" ? `, at most ${time(standing.left)} left` : "";
    write(by("commission-time"), `${time(standing.used)} of rig time used${left}`);
  }

  private showStages({ standing, phase }: Paper): void {
    const shape = JSON.stringify([standing.done, standing.stage, phase]);
    if (shape === this.drawn) return;
    this.drawn = shape;
    const next = STAGES.find(([name]) =>
      name !== standing.stage && !standing.done.some((one) => one.stage === name))?.[0];
    by("stages").replaceChildren(...STAGES.map(([name, about]) => {
      const done = standing.done.find((one) => one.stage === name);
      const now = standing.stage === name;
      const goes = phase === "runs" || phase === "asks" || phase === "before";
      const state = done ? "done" : now ? (goes ? "now" : "not finished")
        : name === next && goes ? "next" : "";
      const item = make("li", { class: done ? "done" : now ? "now" : "" },
        make("span", { class: "stage" }, name), " ",
        make("span", { class: `badge ${done ? "good" : ""}` }, state || "later"), " ",
        make("span", { class: "help" }, done && done.seconds > 0 ? `${about}; took ${time(done.seconds)}` : about));
      if (!state) item.querySelector(".badge")!.remove();
      if (now) item.setAttribute("aria-current", "step");
      if (done?.found.length) {
        item.append(make("dl", { class: "facts" }, ...done.found.flatMap(([what, value]) =>
          [make("dt", {}, what), make("dd", {}, value)])));
      }
      return item;
    }));
  }

  private showFriction(standing: Standing): void {
    by("narrowing").hidden = standing.points.length === 0;
    if (by("narrowing").hidden) return;
    const wanted = new Map(standing.wanted);
    const names = Object.keys(KINDS);
    const of = (name: string) => standing.narrowed.flatMap((one): [number, number][] => {
      const ranged = one.parameters.find(([parameter]) => parameter === name)?.[1];
      const half = ranged && relative(ranged);
      return half === undefined ? [] : [[one.blocks, half]];
    });
    const lines = names.map((name): Line => ({
      name, kind: KINDS[name]!, points: of(name),
      goal: wanted.has(name) ? wanted.get(name)! * 100 : undefined,
    }));
    chart(by<never>("narrowing-chart"),
      { x: "blocks", y: "half of the 95 % interval [% of the value]", logY: true }, lines);
    this.showCurve(standing);
    const last = standing.narrowed.at(-1);
    by("intervals").replaceChildren(...names.map((name) => {
      const ranged = last?.parameters.find(([parameter]) => parameter === name)?.[1];
      const half = ranged && relative(ranged);
      const goal = wanted.get(name);
      const met = goal === undefined ? "" : half !== undefined && half <= 100 * goal ? "met" : "not yet";
      return make("tr", {},
        make("th", { scope: "row" }, name),
        make("td", {}, ranged ? `${short(ranged.value)} ${UNITS[name]}` : "not known yet"),
        make("td", {}, half === undefined ? (ranged ? "open" : "") : `± ${half.toFixed(1)} %`),
        make("td", {}, goal === undefined ? "" : `± ${short(100 * goal)} %`),
        make("td", { class: met === "met" ? "good" : "" }, met));
    }));
  }

  private showCurve({ curve, points }: Standing): void {
    const slope = curve?.slope.value ?? 0;
    const measured: Line = {
      name: "measured", kind: "measured", dots: true,
      points: points.map(([speed, volts]) => [speed, volts - slope * speed]),
    };
    const lines = [measured];
    const speeds = points.map(([speed]) => speed);
    if (curve && speeds.length) {
      const [low, high] = [Math.min(...speeds), Math.max(...speeds)];
      const fitted = Array.from({ length: 80 }, (_, at): [number, number] => {
        const speed = low * (high / low) ** (at / 79);
        const dip = curve.dips
          ? (curve.f_s.value - curve.f_c.value) * Math.exp(-((speed / curve.v_s.value) ** 2)) : 0;
        return [speed, curve.f_c.value + dip];
      });
      lines.push({ name: "curve", kind: "estimated", points: fitted });
    }
    chart(by<never>("curve-chart"), { x: "speed [rad/s]", y: "friction [V]", logX: true }, lines);
  }

  private showEnd(paper: Paper): void {
    const { standing } = paper;
    const over = paper.phase === "done" || paper.phase === "ended";
    by("verdict").hidden = !over;
    if (over) {
      const good = paper.phase === "done";
      by("verdict").className = good ? "verdict" : "verdict bad";
      const said = good ? (standing.worth ?? "") : `It ended: ${paper.why ?? ""}`;
      write(by("verdict-said"), said);
      write(by("verdict-hint"), good ? `Parameters and report are in ${standing.folder}.` : paper.hint);
      void this.linkReport(paper);
    }
    const lines = by("commission-lines");
    if (lines.childElementCount !== standing.lines.length) {
      lines.replaceChildren(...standing.lines.map((line) => make("li", {}, line)));
    }
    lines.hidden = standing.lines.length === 0;
  }

  /** The report is there once it is listed. */
  private async linkReport({ phase, standing: { folder } }: Paper): Promise<void> {
    const link = by<HTMLAnchorElement>("verdict-report");
    link.hidden = true;
    if (phase !== "done" || !folder) return;
    await this.runs.list();
    const report = this.runs.report(folder);
    link.hidden = !report;
    if (report) link.href = report;
  }

  private async answer(answer: "yes" | "no"): Promise<void> {
    await this.call("consent-said", this.consent, { question: this.asked, answer });
  }

  private async end(): Promise<void> {
    await this.call("commission-said", this.stop, {});
  }

  private async call(place: string, service: string, request: object): Promise<void> {
    const said = by(place);
    said.className = "said";
    write(said, "asked …");
    try {
      const answer = await this.client().call(service, request, 40000);
      if (answer["success"] !== true) throw new Error(String(answer["message"]));
      said.className = "said good";
      write(said, String(answer["message"]));
    } catch (error) {
      said.className = "said bad";
      write(said, (error as Error).message);
    }
  }
}

/** Half the interval over the value [%]; none where an end is open. */
function relative({ value, low, high }: Ranged): number | undefined {
  if (low === null || high === null || !value) return undefined;
  const half = (Math.abs((high - low) / value) / 2) * 100;
  return Number.isFinite(half) ? half : undefined;
}
