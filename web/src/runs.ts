// Folders of results: their reports and bags.

import { Client } from "./client";
import { by, make, write } from "./dom";

interface Run {
  folder: number;
  name: string;
  path: string;
  /** When it was changed last [s since the epoch]. */
  changed: number;
  report: boolean;
  bag: string | null;
  files: string[];
}

const LIST = "/view/list_runs";

export class Runs {
  private all: Run[] = [];
  private asked: Promise<void> = Promise.resolve();
  /** Where files lie on the server. */
  files = "";

  constructor(private readonly client: () => Client) {
    by("runs-again").addEventListener("click", () => void this.list());
  }

  services(names: string[]): void {
    by("runs").hidden = !names.includes(LIST);
    if (!by("runs").hidden) void this.list();
  }

  /** Looks once more which there are. */
  list(): Promise<void> {
    // Whoever asks again wants to know of what is there by then.
    this.asked = this.asked.then(() => this.ask());
    return this.asked;
  }

  private async ask(): Promise<void> {
    const said = by("runs-said");
    try {
      const answer = await this.client().call(LIST, {});
      const before = JSON.stringify([this.files, this.all]);
      this.all = answer["runs"] as Run[];
      const more = Number(answer["left_out"]);
      said.className = "said";
      write(said, this.all.length
        ? `${this.all.length} in ${answer["root"]}${more ? `, and ${more} older ones` : ""}`
        : `none in ${answer["root"]} yet`);
      // Rows that are there keep the focus.
      if (JSON.stringify([this.files, this.all]) !== before) this.show();
    } catch (error) {
      said.className = "said bad";
      write(said, `the list did not come: ${(error as Error).message}`);
    }
  }

  /** Where the report of a folder is; none where it has none. */
  report(folder: string): string | undefined {
    const name = folder.split("/").filter(Boolean).at(-1);
    const run = this.all.find((one) => one.path === folder) ?? this.all.find((one) => one.name === name);
    return run?.report ? this.address(run, "report.html") : undefined;
  }

  private address(run: Run, name: string): string {
    return `${this.files}${run.folder}/${name}`;
  }

  private show(): void {
    by("runs-rows").replaceChildren(...this.all.map((run) => {
      const link = (name: string, text: string) => make("a", {
        href: this.address(run, name), target: "_blank", rel: "noopener",
        "aria-label": `${text} of ${run.name}`,
      }, text);
      const files = run.files.flatMap((name) => [link(name, name), " "]);
      return make("tr", {},
        make("th", { scope: "row" }, run.name),
        make("td", {}, new Date(run.changed * 1000).toLocaleString()),
        make("td", {}, run.report ? link("report.html", "report") : "none"),
        make("td", {}, ...files),
        make("td", {}, run.bag ? make("code", {}, `frictionlab view ${quoted(run.bag)}`) : ""));
    }));
  }
}

/** A path as a shell takes it. */
function quoted(path: string): string {
  return /^[\w./-]+$/.test(path) ? path : `'${path.replaceAll("'", "'\\''")}'`;
}
