// Builds a page as one file with its scripts and styles inside, so that it opens from the file
// system. Its policy allows only these. `--mode sweep` builds sweep.html, otherwise index.html, which `--mode edit` makes
// the page of `pliant edit`.

import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";

import { defineConfig, type Plugin } from "vite";

const allow = (text: string) => `'sha256-${createHash("sha256").update(text, "utf8").digest("base64")}'`;

// Observable Plot puts this style into each drawing of the class.
const drawn = `:where(.takes) {
  --plot-background: white;
  display: block;
  height: auto;
  height: intrinsic;
  max-width: 100%;
}
:where(.takes text),
:where(.takes tspan) {
  white-space: pre;
}`;

// The policy is in the page itself; the command also reads it there for its server's answers.
function policy(scripts: string[], styles: string[]): string {
  const rules = [
    "default-src 'none'",
    `script-src ${scripts.map(allow).join(" ")}`,
    `style-src ${styles.map(allow).join(" ")}`,
    "img-src data: blob:",
    "connect-src 'self'",
    "base-uri 'none'",
    "form-action 'none'",
  ];
  return `<meta http-equiv="Content-Security-Policy" content="${rules.join("; ")}">`;
}

// What several pages have: `<!-- include FILE -->`, alone on its line, becomes the text of the file; `<!-- FILE in MODE -->`
// in that mode only.
function included(mode: string): Plugin {
  const line = /^ *<!-- (?:include (\S+)|(\S+) in (\S+)) -->\n/gm;
  const textOf = (file: string) => readFileSync(new URL(file, import.meta.url), "utf8");
  const main = mode === "edit" ? "/src/edit/main.ts" : "/src/main.ts";
  return {
    name: "included",
    transformIndexHtml: {
      order: "pre",
      handler: (html) =>
        html
          .replace(line, (_, file?: string, part?: string, only?: string) => (file ? textOf(file) : only === mode ? textOf(part!) : ""))
          .replace("/src/main.ts", main),
    },
  };
}

function inlined(): Plugin {
  return {
    name: "inlined",
    enforce: "post",
    generateBundle(_, bundle) {
      const page = Object.values(bundle).find((each) => each.fileName.endsWith(".html"));
      if (page?.type !== "asset") throw new Error("no page among what was built");
      let html = String(page.source);
      const scripts: string[] = [];
      const styles: string[] = [];
      for (const [name, part] of Object.entries(bundle)) {
        if (part === page) continue;
        const text = part.type === "chunk" ? part.code : String(part.source);
        // The replacement is a function, since $& and the like have a meaning in a replacement
        // text.
        const put = (tag: RegExp, element: () => string) => (html = html.replace(tag, element));
        const place = name.replaceAll(".", "\\.");
        if (part.type === "chunk") {
          put(new RegExp(`<script[^>]*src="[^"]*${place}"[^>]*></script>`), () => "");
          // Last in the page, after the elements that it uses.
          const script = text.replaceAll("</script", "<\\/script");
          scripts.push(script);
          put(/<\/body>/, () => `<script type="module">${script}</script>\n</body>`);
        } else {
          styles.push(text);
          put(new RegExp(`<link[^>]*href="[^"]*${place}"[^>]*>`), () => `<style>${text}</style>`);
        }
        delete bundle[name];
      }
      // The policy must come before all content that it covers.
      if (scripts.some((script) => script.includes("--plot-background"))) styles.push(drawn);
      page.source = html.replace(/<meta charset="utf-8">/, (charset) => `${charset}\n${policy(scripts, styles)}`);
    },
  };
}

export default defineConfig(({ mode }) => ({
  base: "./",
  plugins: [included(mode), inlined()],
  build: {
    target: "es2022", modulePreload: false, assetsInlineLimit: 0, reportCompressedSize: false, emptyOutDir: false,
    rollupOptions: { input: mode === "sweep" ? "sweep.html" : "index.html" },
  },
}));
