// Experiments: pick one, start it, see how far it is, end it.

import { Client } from "./client";
import { Message } from "./cdr";
import { by, make, write } from "./dom";
import { Runs } from "./runs";
import { time } from "./words";

interface Option {
  name: string;
  description: string;
  default_value: string;
  choices: string[];
}

interface Experiment {
  name: string;
  description: string;
  duration: number;
  quick_duration: number;
  parameters: Option[];
}

export class Experiments {
  private all: Experiment[] = [];
  private listed = "";
  private namespace = "";
  mayChange = true;

  constructor(
    private readonly client: () => Client,
    private readonly runs: Runs,
  ) {
    by("experiment").addEventListener("change", () => this.describe());
    by("start").addEventListener("click", () => void this.start());
    by("abort").addEventListener("click", () => void this.abort());
  }

  services(names: string[]): void {
    const end = "/experiment_runner/list_experiments";
    const list = names.find((name) => name.endsWith(end));
    const abort = names.find((name) => name.endsWith("/experiment_runner/abort"));
    // A commission that is no experiment has a stop of its own.
    by("experiments").hidden = !abort || names.includes("/commission/consent");
    by("pick").hidden = by("more").hidden = !list;
    if (abort) this.namespace = abort.slice(0, -"/experiment_runner/abort".length);
    if (!list) return;
    void this.list(list);
  }

  enable(): void {
    const works = this.client().isOpen && this.mayChange;
    by<HTMLButtonElement>("start").disabled = !works;
    by<HTMLButtonElement>("abort").disabled = !works;
  }

  private async list(name: string): Promise<void> {
    try {
      const answer = await this.client().call(name, {}, 15000);
      // Asked for again when the network changes: what was typed stays where the list is the same.
      const listed = JSON.stringify(answer["experiments"]);
      if (listed === this.listed) return;
      this.listed = listed;
      this.all = answer["experiments"] as Experiment[];
      const select = by<HTMLSelectElement>("experiment");
      const before = select.value;
      select.replaceChildren(
        ...this.all.map((one) => make("option", { value: one.name }, one.name)));
      if (before) select.value = before;
      this.describe();
    } catch (error) {
      this.say(`the experiments are not known: ${(error as Error).message}`, false);
    }
  }

  private chosen(): Experiment | undefined {
    return this.all.find((one) => one.name === by<HTMLSelectElement>("experiment").value);
  }

  private describe(): void {
    const chosen = this.chosen();
    const place = by("experiment-options");
    place.replaceChildren();
    if (!chosen) return;
    write(by("experiment-about"),
      `${chosen.description}. About ${time(chosen.duration)}, quick ${time(chosen.quick_duration)}.`);
    for (const option of chosen.parameters) {
      const id = `o-${option.name}`;
      const label = make("label", { for: id }, option.name);
      const help = make("p", { class: "help", id: `${id}-help` }, option.description);
      const control = option.choices.length
        ? make("select", { id },
            make("option", { value: "" }, option.default_value || "as usual"),
            ...option.choices.map((name) => make("option", { value: name }, name)))
        : make("input", { id, type: "text", placeholder: option.default_value });
      control.setAttribute("data-option", option.name);
      control.setAttribute("aria-describedby", `${id}-help`);
      place.append(make("div", { class: "row" }, label, control, help));
    }
  }

  private async start(): Promise<void> {
    const chosen = this.chosen();
    if (!chosen) return;
    const overrides: { name: string; value: string }[] = [];
    const controls = document.querySelectorAll<HTMLInputElement>("[data-option]");
    for (const one of controls) {
      if (one.value) overrides.push({ name: one.dataset["option"]!, value: one.value });
    }
    if (by<HTMLInputElement>("quick").checked && !overrides.some((one) => one.name === "quick")) {
      overrides.push({ name: "quick", value: "true" });
    }
    await this.call("start_experiment", { experiment: chosen.name, overrides }, 15000);
  }

  private async abort(): Promise<void> {
    await this.call("abort", {}, 40000);
  }

  private async call(name: string, request: object, patience: number): Promise<void> {
    this.say("asked …", true);
    try {
      const whole = `${this.namespace}/experiment_runner/${name}`;
      const answer = await this.client().call(whole, request, patience);
      this.say(String(answer["message"] || "done"), answer["success"] === true);
    } catch (error) {
      this.say((error as Error).message, false);
    }
  }

  private say(text: string, good: boolean): void {
    const said = by("experiment-said");
    said.className = good ? "said good" : "said bad";
    write(said, text);
  }

  /** Takes how far it is. */
  status(message: Message): void {
    const progress = Number(message["progress"]);
    const bar = by<HTMLProgressElement>("progress");
    bar.value = Number.isFinite(progress) ? progress : 0;
    const left = Number(message["remaining"]);
    const parts = [
      String(message["experiment"] ?? ""),
      String(message["stage"] ?? ""),
      `${Math.round(bar.value * 100)} %`,
      Number.isFinite(left) && left > 0 ? `${time(left)} left` : "",
      String(message["message"] ?? ""),
      message["bag_path"] ? `bag: ${String(message["bag_path"])}` : "",
    ];
    write(by("experiment-status"), parts.filter(Boolean).join(" · "));
    const ended = message["stage"] === "idle" && String(message["bag_path"] ?? "");
    if (ended) void this.linkReport(ended);
    else by("experiment-report").hidden = true;
  }

  /** What ended has a report, once it is listed. */
  private async linkReport(bag: string): Promise<void> {
    const link = by<HTMLAnchorElement>("experiment-report");
    await this.runs.list();
    const report = this.runs.report(bag.replace(/\/bag\/?$/, ""));
    link.hidden = !report;
    if (report) link.href = report;
  }
}
