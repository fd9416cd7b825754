// The page as one file: scripts and styles stand in it, so that it opens from the file system. They
// are all that its policy lets run.

import { createHash } from "node:crypto";

import { defineConfig, type Plugin } from "vite";

const allow = (text: string) => `'sha256-${createHash("sha256").update(text, "utf8").digest("base64")}'`;

// In the page itself; the command finds it there for the answers of its server, too.
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

function inlined(): Plugin {
  return {
    name: "inlined",
    enforce: "post",
    generateBundle(_, bundle) {
      const page = Object.values(bundle).find((each) => each.fileName === "index.html");
      if (page?.type !== "asset") throw new Error("no index.html among what was built");
      let html = String(page.source);
      const scripts: string[] = [];
      const styles: string[] = [];
      for (const [name, part] of Object.entries(bundle)) {
        if (part === page) continue;
        const text = part.type === "chunk" ? part.code : String(part.source);
        // A function as replacement: in a text, $& and the like would mean something.
        const put = (tag: RegExp, element: () => string) => (html = html.replace(tag, element));
        const place = name.replaceAll(".", "\\.");
        if (part.type === "chunk") {
          put(new RegExp(`<script[^>]*src="[^"]*${place}"[^>]*></script>`), () => "");
          // Last in the page: what it shows stands ahead of it.
          const script = text.replaceAll("</script", "<\\/script");
          scripts.push(script);
          put(/<\/body>/, () => `<script type="module">${script}</script>\n</body>`);
        } else {
          styles.push(text);
          put(new RegExp(`<link[^>]*href="[^"]*${place}"[^>]*>`), () => `<style>${text}</style>`);
        }
        delete bundle[name];
      }
      // Ahead of all that it holds for.
      page.source = html.replace(/<meta charset="utf-8">/, (charset) => `${charset}\n${policy(scripts, styles)}`);
    },
  };
}

export default defineConfig({
  base: "./",
  plugins: [inlined()],
  build: { target: "es2022", modulePreload: false, assetsInlineLimit: 0, reportCompressedSize: false },
});
