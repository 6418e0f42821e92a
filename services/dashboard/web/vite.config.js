// SPDX-License-Identifier: Apache-2.0
import { defineConfig } from 'vite';

export default defineConfig({
  base: './',
  build: {
    target: 'es2022',
    emptyOutDir: true,
    assetsInlineLimit: 0, // the page's content security policy takes no data: addresses
    modulePreload: false, // its polyfill would be of no use: there is one chunk
    chunkSizeWarningLimit: 800,
  },
});
