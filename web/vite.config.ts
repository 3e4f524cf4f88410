import { defineConfig, type Plugin } from "vite";

/** The first view's parts are fetched with the page, not after its first script. */
const preloadFirstView: Plugin = {
  name: "preload-first-view",
  transformIndexHtml: {
    order: "post",
    handler(_, { bundle }) {
      const chunks = Object.values(bundle ?? {}).filter((one) => one.type === "chunk");
      const first = chunks.find((one) => one.facadeModuleId?.endsWith("/views/fly/fly.ts"));
      return [first?.fileName, ...(first?.imports ?? [])]
        .filter((file) => file !== undefined)
        .map((file) => ({ tag: "link", attrs: { rel: "modulepreload", href: `/${file}` }, injectTo: "head" as const }));
    },
  },
};

export default defineConfig({
  base: "/",
  plugins: [preloadFirstView],
  build: {
    target: "es2022",
    // Data in URLs is not allowed by the page's content policy for scripts and styles.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 700,
  },
});
