// Parameters of the nodes: controls with range and unit, acknowledged or refused, with undo.

import { Client } from "./client";
import { by, make, write } from "./dom";

type Value = number | string | boolean | number[] | null;

interface Parameter {
  name: string;
  value: Value;
  type: string;
  description: string;
  constraints: string;
  readOnly: boolean;
  range: [number, number] | null;
}

interface Node {
  node: string;
  parameters: Parameter[];
}

interface Row {
  element: HTMLElement;
  said: HTMLElement;
  undo: HTMLButtonElement;
  show(value: Value): void;
  now: Value;
  before: Value | undefined;
}

/** Widest range, high over low, that a slider can be used for. */
const SLIDER = 5000;
/** Ratio of the ends of a range from which on a slider goes by decades. */
const DECADES = 100;

export class Parameters {
  private readonly rows = new Map<string, Row>();
  private readonly undone: { node: string; name: string; value: Value }[] = [];
  private shape = "";
  private nodes: Node[] = [];

  constructor(
    private readonly client: () => Client,
    private readonly mayChange: () => boolean,
  ) {
    by<HTMLInputElement>("filter").addEventListener("input", () => this.filter());
    by("undo").addEventListener("click", () => {
      const last = this.undone.pop();
      if (last) void this.set(last.node, last.name, last.value, false);
    });
    this.tellUndo();
  }

  /** Takes the document of all parameters. */
  take(document: { nodes: Node[] }): void {
    this.nodes = document.nodes;
    const shape = JSON.stringify(
      this.nodes.map((node) => [node.node, node.parameters.map((one) => [one.name, one.type])]),
    );
    if (shape !== this.shape) {
      this.shape = shape;
      this.build();
    }
    for (const node of this.nodes) {
      for (const one of node.parameters) {
        const row = this.rows.get(`${node.node}.${one.name}`);
        if (!row || JSON.stringify(row.now) === JSON.stringify(one.value)) continue;
        row.now = one.value;
        row.show(one.value);
      }
    }
    this.filter();
  }

  /** The value of a parameter, by the end of its node's name. */
  value(node: string, name: string): Value | undefined {
    const found = this.nodes.find((one) => one.node.endsWith(node));
    return found?.parameters.find((one) => one.name === name)?.value;
  }

  private build(): void {
    const place = by("parameters");
    const open = new Set(
      [...place.querySelectorAll("details[open]")].map((one) => one.getAttribute("data-node")),
    );
    const first = !place.firstElementChild;
    place.replaceChildren();
    this.rows.clear();
    const order = [...this.nodes].sort((one, other) => rank(one.node) - rank(other.node));
    for (const node of order) {
      const list = make("div", { class: "rows" });
      for (const one of node.parameters) {
        const row = this.row(node.node, one);
        this.rows.set(`${node.node}.${one.name}`, row);
        list.append(row.element);
      }
      const details = make("details", { "data-node": node.node },
        make("summary", {}, node.node.replace(/^\//, "")), list);
      details.open = open.has(node.node) || (first && rank(node.node) === 0);
      place.append(details);
    }
  }

  private row(node: string, one: Parameter): Row {
    const id = `p-${node}-${one.name}`.replace(/[^\w-]/g, "-");
    const unit = /\[([^\]]+)\][^[]*$/.exec(one.description)?.[1] ?? "";
    const help = [one.description, one.constraints].filter(Boolean).join("; ");
    const said = make("output", { class: "said", for: id });
    const undo = make("button", { type: "button", class: "small" }, "undo");
    undo.setAttribute("aria-label", `undo the change of ${one.name}`);
    undo.hidden = true;
    const { control, also, show } = this.control(id, one, (value) => {
      void this.set(node, one.name, value, true);
    });
    control.setAttribute("aria-describedby", `${id}-help`);
    const label = make("label", { for: id }, one.name);
    const unitText = make("span", { class: "unit" }, unit);
    const element = make("div", { class: "row", "data-name": one.name },
      label, make("div", { class: "controls" }, ...also, control, unitText, undo),
      make("p", { class: "help", id: `${id}-help` }, help), said);
    const row: Row = { element, said, undo, show, now: one.value, before: undefined };
    undo.addEventListener("click", () => {
      if (row.before !== undefined) void this.set(node, one.name, row.before, false);
    });
    return row;
  }

  private control(
    id: string,
    one: Parameter,
    changed: (value: Value) => void,
  ): { control: HTMLElement; also: HTMLElement[]; show(value: Value): void } {
    const fixed = one.readOnly || !this.mayChange() || !plain(one);
    const choices = /^one of ([^;]+)/.exec(one.constraints)?.[1]?.split(", ");
    if (one.type === "bool") {
      const box = make("input", { id, type: "checkbox" });
      box.checked = one.value === true;
      box.disabled = fixed;
      box.addEventListener("change", () => changed(box.checked));
      return { control: box, also: [], show: (value) => (box.checked = value === true) };
    }
    if (choices && one.type === "string") {
      const select = make("select", { id },
        ...choices.map((name) => make("option", { value: name }, name)));
      select.value = String(one.value);
      select.disabled = fixed;
      select.addEventListener("change", () => changed(select.value));
      return { control: select, also: [], show: (value) => (select.value = String(value)) };
    }
    const numeric = one.type === "double" || one.type === "integer";
    const input = make("input", { id, type: numeric ? "number" : "text", autocomplete: "off" });
    if (numeric) input.step = one.type === "integer" ? "1" : "any";
    input.value = text(one.value);
    input.disabled = fixed;
    input.addEventListener("change", () => {
      if (numeric && input.value.trim() === "") return;
      changed(numeric ? Number(input.value) : input.value);
    });
    const also: HTMLElement[] = [];
    const slider = numeric && one.range && usable(one.range) ? one.range : undefined;
    if (!slider) return { control: input, also, show: (value) => (input.value = text(value)) };
    const range = slide(one, slider, (value) => (input.value = short(value)), changed);
    range.element.disabled = fixed;
    also.push(range.element);
    const show = (value: Value) => {
      input.value = text(value);
      range.show(Number(value));
    };
    show(one.value);
    return { control: input, also, show };
  }

  /** Sets one, and says what became of it. */
  private async set(node: string, name: string, value: Value, undoable: boolean): Promise<void> {
    const row = this.rows.get(`${node}.${name}`);
    if (!row) return;
    const before = row.now;
    row.said.className = "said";
    write(row.said, "asked …");
    try {
      const request = { node, values: { [name]: value } };
      const answer = await this.client().call("/view/set_parameters", request);
      if (answer["success"] !== true) throw new Error(String(answer["message"]));
      row.now = value;
      row.show(value);
      row.said.className = "said good";
      write(row.said, `${name} is ${text(value)}`);
      if (undoable) {
        row.before = before;
        this.undone.push({ node, name, value: before });
      } else {
        row.before = undefined;
      }
    } catch (error) {
      row.show(before);
      row.said.className = "said bad";
      write(row.said, `refused: ${(error as Error).message}`);
    }
    row.undo.hidden = row.before === undefined;
    this.tellUndo();
  }

  private tellUndo(): void {
    const last = this.undone.at(-1);
    const button = by<HTMLButtonElement>("undo");
    button.disabled = !last;
    write(button, last ? `Undo ${last.name}` : "Undo");
  }

  /** Shows what the filter names; of the models only the one that runs, unless it names more. */
  private filter(): void {
    const wanted = by<HTMLInputElement>("filter").value.trim().toLowerCase();
    for (const node of this.nodes) {
      const choice = node.parameters.find((one) => one.name === "model");
      const models = /^one of ([^;]+)/.exec(choice?.constraints ?? "")?.[1]?.split(", ") ?? [];
      let shown = 0;
      for (const one of node.parameters) {
        const row = this.rows.get(`${node.node}.${one.name}`);
        if (!row) continue;
        const model = one.name.split(".")[0]!;
        const other = one.name.includes(".") && models.includes(model) && model !== choice?.value;
        const all = `${node.node} ${one.name} ${one.description}`.toLowerCase();
        const usual = one.name === "use_sim_time";
        row.element.hidden = wanted ? !all.includes(wanted) : other || usual || one.readOnly;
        if (!row.element.hidden) shown++;
      }
      const details = by("parameters").querySelector<HTMLDetailsElement>(
        `details[data-node="${CSS.escape(node.node)}"]`);
      if (details && wanted) details.open = shown > 0;
    }
  }

  /** Makes all controls anew, when what this viewer may do has changed. */
  anew(): void {
    this.shape = "";
    if (this.nodes.length) this.take({ nodes: this.nodes });
  }
}

/** The reference is what is changed most. */
function rank(node: string): number {
  return node.endsWith("/reference") ? 0 : 1;
}

/** A slider; over several decades it goes by them. */
function slide(
  one: Parameter,
  [low, high]: [number, number],
  moved: (value: number) => void,
  changed: (value: number) => void,
): { element: HTMLInputElement; show(value: number): void } {
  const byDecades = one.type === "double" && low > 0 && high / low > DECADES;
  const to = (value: number) => (byDecades ? Math.log10(value) : value);
  const from = (at: number) => Number(short(byDecades ? 10 ** at : at));
  const element = make("input", { type: "range", min: String(to(low)), max: String(to(high)) });
  element.step = one.type === "integer" ? "1" : "any";
  element.setAttribute("aria-label", `${one.name}, slider`);
  const say = (value: number) => element.setAttribute("aria-valuetext", short(value));
  element.addEventListener("input", () => {
    const value = from(element.valueAsNumber);
    say(value);
    moved(value);
  });
  element.addEventListener("change", () => changed(from(element.valueAsNumber)));
  const show = (value: number) => {
    if (!Number.isFinite(value)) return;
    element.value = String(to(value));
    say(value);
  };
  return { element, show };
}

function plain(one: Parameter): boolean {
  return ["bool", "integer", "double", "string"].includes(one.type);
}

function usable([low, high]: [number, number]): boolean {
  if (!Number.isFinite(low) || !Number.isFinite(high) || high <= low) return false;
  return high - low <= SLIDER;
}

function short(value: number): string {
  return String(Number(value.toPrecision(6)));
}

function text(value: Value): string {
  if (value === null) return "";
  return Array.isArray(value) ? value.join(", ") : String(value);
}
