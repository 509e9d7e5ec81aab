// The page: what comes is kept, what is kept is drawn, what is asked is sent.

import { Message } from "./cdr";
import { Client, Taker } from "./client";
import { Commission } from "./commission";
import { Curve, Curves } from "./curves";
import { by, make, write } from "./dom";
import { Experiments } from "./experiments";
import { Parameters } from "./parameters";
import { Hysteresis, Stribeck } from "./planes";
import { Player } from "./player";
import { Column, Ring } from "./ring";
import { Runs } from "./runs";
import { Steering } from "./steering";

/** A token stands behind `#`, which no browser sends. It is taken out of the address line. */
const token = new URLSearchParams(location.hash.slice(1)).get("token") ?? undefined;
if (token) history.replaceState(null, "", location.pathname);

const ring = new Ring();
const losses = { cycles: 0, viewer: "" };
let cycle: bigint | undefined;
let hold: number | undefined;

interface Plot {
  title: string;
  unit: string;
  curves: Curve[];
}

const PLOTS: Plot[] = [
  { title: "Reference and response", unit: "rad/s or rad", curves: [
    { column: "feedback", label: "response", colour: "measured" },
    { column: "reference", label: "reference", colour: "estimated", dash: [6, 3] } ] },
  { title: "Error", unit: "rad/s or rad", curves: [
    { column: "error", label: "error", colour: "third" } ] },
  { title: "Friction torque", unit: "N m", curves: [
    { column: "torque", label: "measured", colour: "measured" },
    { column: "estimate", label: "estimated", colour: "estimated" } ] },
  { title: "Residual of the estimate", unit: "N m", curves: [
    { column: "residual", label: "residual", colour: "third" } ] },
  { title: "Voltage", unit: "V", curves: [
    { column: "applied", label: "applied", colour: "measured" },
    { column: "asked", label: "asked for", colour: "estimated", dash: [6, 3] } ] },
  { title: "Velocity", unit: "rad/s", curves: [
    { column: "velocity", label: "tachometer", colour: "measured" } ] },
  { title: "Period of the cycle", unit: "ms", curves: [
    { column: "period", label: "period", colour: "measured" } ] },
];
const KEYS: Record<string, string> = {
  measured: "measured", estimated: "estimated", third: "third",
};

const plots = PLOTS.map((plot) => {
  const place = make("div", { class: "plot", role: "img", "aria-label": plot.title });
  const caption = make("figcaption", {}, `${plot.title} [${plot.unit}]: `);
  plot.curves.forEach((one, at) => {
    caption.append(at ? ", " : "", `${one.label} `, make("span", { class: `key ${KEYS[one.colour]}` }));
  });
  if (plot.title === "Voltage") caption.append(", limits ", make("span", { class: "key bad" }));
  const home = plot.title.startsWith("Period") ? "timing-plot" : "plots";
  by(home).append(make("figure", {}, caption, place));
  return { ...plot, place, drawn: new Curves(place, plot.unit, plot.curves) };
});
const stribeck = new Stribeck(by<HTMLCanvasElement>("stribeck"));
const hysteresis = new Hysteresis(by<HTMLCanvasElement>("hysteresis"));

let access = "full";
const mayChange = () => access === "full";
const now = (): Client => client;
const steering = new Steering(now);
const runs = new Runs(now);
const commission = new Commission(now, runs);
const experiments = new Experiments(now, runs);
const parameters = new Parameters(now, mayChange);
const player = new Player(now);

const client: Client = new Client(
  {
    opened(info) {
      access = info.access;
      if (info.another) {
        clear();
        commission.clear();
      }
      steering.mayChange = experiments.mayChange = commission.mayChange = mayChange();
      runs.files = info.files;
      cycle = undefined;
      by("lost").hidden = true;
      by("stop").classList.remove("lost");
      const connection = by("connection");
      connection.className = "badge good";
      write(connection, mayChange() ? "connected" : "connected, to look only");
      document.title = info.name;
      player.range(info.start, info.end);
      parameters.anew();
      steering.enable();
      experiments.enable();
      commission.enable();
    },
    closed() {
      by("lost").hidden = false;
      by("stop").classList.add("lost");
      const connection = by("connection");
      connection.className = "badge bad";
      write(connection, "no connection");
      const rig = by("rig");
      rig.className = "badge bad";
      write(rig, "rig: unknown");
      steering.lost();
      experiments.enable();
      commission.enable();
    },
    services(names) {
      steering.services(names);
      experiments.services(names);
      commission.services(names);
      runs.services(names);
    },
    // Topics may lie in a namespace: their last part tells which it is.
    taker: (topic) => SHOWN.get(topic.slice(topic.lastIndexOf("/") + 1)),
    status(level, text, id) {
      if (id === "losses") losses.viewer = text;
      else log(level === 2 ? "error" : level === 1 ? "warn" : "", "view", text);
    },
    playback(state) {
      if (state.sought) clear();
      player.take(state);
    },
  },
  token,
);

function stamp(message: Message): number {
  const at = (message["header"] as Message)["stamp"] as Message;
  return Number(at["sec"]) + Number(at["nanosec"]) / 1e9;
}

function put(message: Message, columns: [Column, string][]): number {
  const row = ring.row(stamp(message));
  for (const [column, field] of columns) ring.set(row, column, Number(message[field]));
  return row;
}

/** What is shown, and by whom. Each other topic would cost time a thousand times a second. */
const SHOWN = new Map<string, Taker>([
  ["rig_measurement", measured],
  ["controller_state", (message) =>
    void put(message, [["reference", "reference"], ["feedback", "feedback"], ["error", "error"]])],
  ["friction_estimate", (message) =>
    void put(message, [["estimate", "torque"], ["residual", "residual"]])],
  ["diagnostics", diagnostics],
  ["experiment_status", (message) => experiments.status(message)],
  ["parameters", (message) => {
    by("settings").hidden = false;
    parameters.take(message as never);
    limits();
  }],
  ["commission", (message) => commission.take(message as never)],
  ["curve", (message) => {
    stribeck.curve = message as never;
    write(by("curve-model"), `(${String(message["model"])})`);
  }],
  ["rosout", (message) => {
    const level = Number(message["level"]);
    log(level >= 4 ? "error" : level === 3 ? "warn" : "", String(message["name"]),
      String(message["message"]));
  }],
]);

function measured(message: Message): void {
  const number = message["cycle"] as bigint;
  // A rig that was opened anew, or a recording that was sought, begins elsewhere.
  if (cycle !== undefined && number > cycle + 1n) losses.cycles += Number(number - cycle - 1n);
  cycle = number;
  if (ring.count && stamp(message) < ring.last - 1) clear();
  const row = put(message, [
    ["position", "encoder_position"], ["velocity", "tachometer_velocity"], ["torque", "torque"],
    ["asked", "voltage_asked"], ["applied", "voltage_applied"],
  ]);
  if (row > ring.first) ring.set(row, "period", (ring.at(row) - ring.at(row - 1)) * 1e3);
  const torque = Number(message["torque"]);
  const velocity = Number(message["tachometer_velocity"]);
  stribeck.add(velocity, torque);
  if (Number(number) % 5 === 0) hysteresis.add(Number(message["encoder_position"]), torque);
}

function clear(): void {
  ring.clear();
  stribeck.clear();
  hysteresis.clear();
  cycle = undefined;
}

/** The rows of the table, by node and name. */
const table = new Map<string, string>();

function diagnostics(message: Message): void {
  for (const one of message["status"] as Message[]) {
    const name = String(one["name"]);
    const values = new Map((one["values"] as Message[]).map((pair) =>
      [String(pair["key"]), String(pair["value"])]));
    if (name.endsWith("rig_driver: control loop")) rig(Number(one["level"]), one, values);
    for (const [key, value] of values) {
      if (/period|age|overruns|stale|not published|not recorded|keep up|execution/.test(key)) {
        table.set(`${name}: ${key}`, value);
      }
    }
    const limit = Number(values.get("voltage limit in force [V]"));
    if (Number.isFinite(limit) && limit > 0) voltageLimit(limit);
  }
}

function rig(level: number, status: Message, values: Map<string, string>): void {
  const badge = by("rig");
  const stopped = values.get("emergency stop") === "set";
  const state = stopped ? "emergency stop" : (values.get("state") ?? "unknown");
  badge.className = level >= 2 ? "badge bad" : state === "active" ? "badge good" : "badge";
  write(badge, `rig: ${state}`);
  badge.title = String(status["message"]);
  if (!stopped && values.get("state") === "active" && by("stop-said").classList.contains("good")) {
    write(by("stop-said"), "");
  }
}

function limits(): void {
  const limit = parameters.value("rig_driver", "voltage_limit");
  if (typeof limit === "number") voltageLimit(limit);
}

function voltageLimit(limit: number): void {
  const voltage = plots.find((plot) => plot.title === "Voltage");
  if (voltage) voltage.drawn.limits = [-limit, limit];
  by<HTMLInputElement>("jog-volts").max = String(limit);
}

/** Lines of the log that are kept. */
const LINES = 200;

function log(kind: string, name: string, text: string): void {
  const list = by("log");
  list.prepend(make("li", { class: kind }, `${name}: ${text}`));
  while (list.children.length > LINES) list.lastElementChild!.remove();
}

// Controls of the curves.
by("hold").addEventListener("click", () => {
  hold = hold === undefined ? ring.last : undefined;
  by("hold").setAttribute("aria-pressed", String(hold !== undefined));
});
by("clear").addEventListener("click", () => {
  stribeck.clear();
  hysteresis.clear();
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  for (const plot of plots) plot.drawn.make();
});

/** Time between two pictures [ms]. */
const PICTURE = 33;
/** Share of the time that drawing may take. */
const SHARE = 0.5;
let next = 0;
let slow = 0;
let frames = 0;

function frame(at: number): void {
  requestAnimationFrame(frame);
  if (at < next) return;
  const began = performance.now();
  const to = hold ?? ring.last;
  if (Number.isFinite(to)) {
    const span = Number(by<HTMLSelectElement>("span").value);
    for (const plot of plots) plot.drawn.draw(ring, to, span);
  }
  stribeck.draw();
  hysteresis.draw();
  frames++;
  // Thirty pictures a second are enough; a slow machine draws less often, and has time left for
  // messages.
  next = at + Math.min(250, Math.max(PICTURE, (performance.now() - began) / SHARE) - 8);
  if (at > slow + 1000) {
    slow = at;
    everySecond();
  }
}

function everySecond(): void {
  for (const plot of plots) {
    plot.place.setAttribute("aria-label", `${plot.title}: ${plot.drawn.words(ring)}`);
  }
  write(by("stribeck-said"), `${stribeck.points} points`);
  table.set("this page: cycles that did not come", String(losses.cycles));
  table.set("this page: pictures a second", String(frames));
  if (losses.viewer) table.set("this page: losses", losses.viewer);
  frames = 0;
  const body = by("timing");
  const rows = [...table].sort(([one], [other]) => one.localeCompare(other));
  body.replaceChildren(...rows.map(([key, value]) => make("tr", {},
    make("th", { scope: "row" }, key), make("td", {}, value))));
}

client.connect();
requestAnimationFrame(frame);
