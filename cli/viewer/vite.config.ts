// The page as one file: scripts and styles stand in it, so that it opens from the file system.

import { defineConfig, type Plugin } from "vite";

function inlined(): Plugin {
  return {
    name: "inlined",
    enforce: "post",
    generateBundle(_, bundle) {
      const page = Object.values(bundle).find((each) => each.fileName === "index.html");
      if (page?.type !== "asset") throw new Error("no index.html among what was built");
      let html = String(page.source);
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
          put(/<\/body>/, () => `<script type="module">${script}</script>\n</body>`);
        } else {
          put(new RegExp(`<link[^>]*href="[^"]*${place}"[^>]*>`), () => `<style>${text}</style>`);
        }
        delete bundle[name];
      }
      page.source = html;
    },
  };
}

export default defineConfig({
  base: "./",
  plugins: [inlined()],
  build: { target: "es2022", modulePreload: false, assetsInlineLimit: 0, reportCompressedSize: false },
});
