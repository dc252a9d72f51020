// Bundle the page into dist/: one script, its style sheet, and both compressed.
import { readFile, rm, mkdir, copyFile, readdir, writeFile } from "node:fs/promises";
import { constants, brotliCompressSync, gzipSync } from "node:zlib";
import { join } from "node:path";
import { build } from "esbuild";

const DIST = "dist";

await rm(DIST, { recursive: true, force: true });
await mkdir(DIST);
await build({
  entryPoints: { page: "src/page/main.ts", board: "src/board/main.ts" },
  bundle: true,
  minify: true,
  format: "esm",
  target: ["es2022"],
  legalComments: "linked",
  outdir: DIST,
});
for (const name of await readdir("static")) {
  await copyFile(join("static", name), join(DIST, name));
}
for (const name of await readdir(DIST)) {
  const content = await readFile(join(DIST, name));
  const quality = { [constants.BROTLI_PARAM_QUALITY]: 11 };
  await writeFile(join(DIST, `${name}.gz`), gzipSync(content, { level: 9 }));
  await writeFile(join(DIST, `${name}.br`), brotliCompressSync(content, { params: quality }));
}
