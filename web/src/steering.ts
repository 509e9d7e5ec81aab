// The emergency stop, states of the nodes, and jogging by hand.

import { Client } from "./client";
import { by, write } from "./dom";

/** Time between two voltages of a jog [ms]: well within the age of a command. */
const JOG = 8;
/** Time that the driver is given to find this page's voltages [ms]. */
const FOUND = 2000;
/** How often an emergency stop that was not confirmed is asked for again. */
const STOPS = 5;

export class Steering {
  private stopping = false;
  private jogging: number | undefined;
  /** The motor is in the hands of this page. */
  private jogs = false;
  private volts = 0;
  private namespace = "";
  mayChange = true;

  constructor(private readonly client: () => Client) {
    by("stop").addEventListener("click", () => void this.stop());
    document.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.preventDefault();
      void this.stop();
    });
    for (const button of document.querySelectorAll<HTMLButtonElement>("button[data-call]")) {
      button.addEventListener("click", () => void this.ask(button));
    }
    by("jog-ready").addEventListener("click", () => void this.ready());
    by("jog-end").addEventListener("click", () => void this.endJog());
    this.hold(by<HTMLButtonElement>("jog-back"), -1);
    this.hold(by<HTMLButtonElement>("jog-ahead"), 1);
    const release = () => this.release();
    window.addEventListener("blur", release);
    document.addEventListener("visibilitychange", release);
    window.addEventListener("pointerup", release);
    const volts = by<HTMLInputElement>("jog-volts");
    volts.addEventListener("input", () => write(by("jog-volts-said"), `${volts.value} V`));
  }

  /** Learns the names of the services, and with them the namespace. */
  services(names: string[]): void {
    const stop = names.find((name) => name.endsWith("/rig_driver/emergency_stop"));
    this.namespace = stop ? stop.slice(0, -"/rig_driver/emergency_stop".length) : "";
    const offered = (name: string) => names.includes(`${this.namespace}/${name}`);
    const buttons = [...document.querySelectorAll<HTMLButtonElement>("button[data-call]")];
    for (const button of buttons) button.hidden = !offered(button.dataset["call"]!);
    by("by-hand").hidden = !offered("controller/change_state");
    by("steering").hidden = buttons.every((button) => button.hidden);
    this.enable();
  }

  /** The connection is lost: nothing here works. */
  lost(): void {
    this.volts = 0;
    this.stopJogging();
    this.enable();
  }

  enable(): void {
    const works = this.client().isOpen && this.mayChange;
    for (const button of document.querySelectorAll<HTMLButtonElement>("#steering button")) {
      button.disabled = !works;
    }
    const jogs = works && this.jogs;
    by<HTMLButtonElement>("jog-back").disabled = !jogs;
    by<HTMLButtonElement>("jog-ahead").disabled = !jogs;
    by<HTMLButtonElement>("jog-end").disabled = !jogs;
    by<HTMLButtonElement>("jog-ready").disabled = !works || this.jogging !== undefined;
  }

  /** The emergency stop. It is never disabled: where it cannot work it says so. */
  async stop(): Promise<void> {
    const said = by("stop-said");
    this.volts = 0;
    this.stopJogging();
    if (this.stopping) return;
    this.stopping = true;
    said.className = "alarm";
    for (let at = 1; at <= STOPS; at++) {
      try {
        if (!this.mayChange) throw new Error("this viewer may only look");
        write(said, "Emergency stop asked for …");
        const name = `${this.namespace}/rig_driver/emergency_stop`;
        const answer = await this.client().call(name, {}, 3000);
        if (answer["success"] !== true) throw new Error(String(answer["message"]));
        said.className = "alarm good";
        write(said, "Emergency stop: the motor is at zero volts until the fault is cleared.");
        break;
      } catch (error) {
        const why = (error as Error).message;
        said.className = "alarm";
        write(said, `The emergency stop was NOT confirmed: ${why}. Use the switch of the rig.`);
        if (!this.client().isOpen || !this.mayChange) break;
        await new Promise((done) => setTimeout(done, 200));
      }
    }
    this.stopping = false;
    this.enable();
  }

  private async ask(button: HTMLButtonElement): Promise<void> {
    const label = button.dataset["transition"];
    const request = label ? { transition: { label } } : {};
    await this.call(button.dataset["call"]!, request, button.textContent ?? "");
  }

  private async call(name: string, request: object, what: string): Promise<boolean> {
    const said = by("steering-said");
    said.className = "said";
    write(said, `${what}: asked …`);
    try {
      const answer = await this.client().call(`${this.namespace}/${name}`, request, 8000);
      if (answer["success"] === false) {
        throw new Error(String(answer["message"] || "the node did not do it; its log says why"));
      }
      said.className = "said good";
      write(said, `${what}: ${answer["message"] || "done"}`);
      return true;
    } catch (error) {
      said.className = "said bad";
      write(said, `${what}: ${(error as Error).message}`);
      return false;
    }
  }

  private change(node: string, label: string): Promise<boolean> {
    const request = { transition: { label } };
    return this.call(`${node}/change_state`, request, `${label} ${node}`);
  }

  private async phase(node: string): Promise<string> {
    try {
      const answer = await this.client().call(`${this.namespace}/${node}/get_state`, {});
      return String(answer["current_state"]?.label ?? "");
    } catch {
      return "";
    }
  }

  /** Whether a node rests: one in a fault does already, an active one is deactivated. */
  private async rests(node: string): Promise<boolean> {
    const phase = await this.phase(node);
    if (phase === "inactive" || phase === "unconfigured") return true;
    // Of one that does not tell its state nothing is believed.
    return this.change(node, "deactivate");
  }

  /** Hands the motor to this page: the controller rests, the driver takes voltages from here. */
  private async ready(): Promise<void> {
    if (!(await this.rests("rig_driver")) || !(await this.rests("controller"))) return;
    this.volts = 0;
    // The driver must have found this commander when it begins to wait for voltages.
    this.jogging = window.setInterval(() => {
      const sent = this.client().publish(`${this.namespace}/motor_voltage`, { voltage: this.volts });
      if (!sent && !this.client().isOpen) this.stopJogging();
    }, JOG);
    write(by("steering-said"), "by hand: one moment …");
    await new Promise((done) => setTimeout(done, FOUND));
    this.jogs = await this.change("rig_driver", "activate");
    if (!this.jogs) this.stopJogging();
    this.enable();
  }

  private stopJogging(): void {
    if (this.jogging === undefined) return;
    clearInterval(this.jogging);
    this.jogging = undefined;
    this.jogs = false;
    this.enable();
  }

  private async endJog(): Promise<void> {
    this.volts = 0;
    if (!(await this.rests("rig_driver"))) return;
    this.stopJogging();
    await this.change("controller", "activate");
  }

  private release(): void {
    this.volts = 0;
    by("jog-back").classList.remove("held");
    by("jog-ahead").classList.remove("held");
  }

  /** A button that moves only while it is held. */
  private hold(button: HTMLButtonElement, sign: number): void {
    const press = () => {
      if (this.jogging === undefined) return;
      this.volts = sign * Number(by<HTMLInputElement>("jog-volts").value);
      button.classList.add("held");
    };
    const release = () => this.release();
    button.addEventListener("pointerdown", press);
    for (const end of ["pointerup", "pointercancel", "pointerleave", "blur", "contextmenu"]) {
      button.addEventListener(end, release);
    }
    button.addEventListener("keydown", (event) => {
      if (event.key !== " " && event.key !== "Enter") return;
      event.preventDefault();
      if (!event.repeat) press();
    });
    button.addEventListener("keyup", release);
  }
}
