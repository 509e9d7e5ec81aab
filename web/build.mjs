// Builds web/dist from web/src. The same sources give the same bytes: nothing in them depends on
// the machine, the folder or the time.

import { build } from "esbuild";
import { copyFile, mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
process.chdir(here);
const out = process.argv[2] ?? "dist";
await mkdir(out, { recursive: true });

const licence = (await readFile("node_modules/uplot/LICENSE", "utf8")).trim();
await build({
  entryPoints: ["src/app.ts"],
  bundle: true,
  minify: true,
  format: "iife",
  target: ["chrome100", "firefox100", "safari15"],
  charset: "utf8",
  legalComments: "none",
  banner: { js: `/* uPlot 1.6.32\n${licence}\n*/` },
  outfile: join(out, "app.js"),
});
const plot = await readFile("node_modules/uplot/dist/uPlot.min.css", "utf8");
const own = await readFile("src/app.css", "utf8");
await writeFile(join(out, "app.css"), `/* uPlot 1.6.32, MIT */\n${plot.trim()}\n${own}`);
for (const name of ["index.html", "icon.svg"]) {
  await copyFile(join("src", name), join(out, name));
}
