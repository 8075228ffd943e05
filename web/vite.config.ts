// How Vite builds the viewer into dist/ and, for `npm run dev`, forwards the API to a running service.
import { defineConfig } from "vite";

// No inline scripts and no data: URLs in the output, so that a strict Content-Security-Policy holds.
export default defineConfig({
  build: {
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 900,
    rollupOptions: {
      input: ["index.html", "studies.html"],
      output: {
        manualChunks: (id) => (id.includes("/three/") ? "three" : undefined),
      },
    },
  },
  server: { proxy: { "/v1": { target: process.env.TRUESTEP_URL ?? "http://127.0.0.1:8080", ws: true } } },
});
