// SPDX-License-Identifier: Apache-2.0
// What a browser must load before it shows anything.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';

const page = process.env.PAGE_TEST_PAGE;
const MAX_KB = 800;
const MAX_GZIP_KB = 220;

function files(folder) {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => (entry.isDirectory() ? files(join(folder, entry.name)) : [join(folder, entry.name)]));
}

test('the page is small', () => {
  let [bytes, zipped] = [0, 0];
  for (const file of files(page)) {
    const content = readFileSync(file);
    bytes += content.length;
    zipped += gzipSync(content).length;
  }
  console.log(`bundle: ${(bytes / 1000).toFixed(0)} kB, gzip ${(zipped / 1000).toFixed(0)} kB; budget ${MAX_KB} and ${MAX_GZIP_KB}`);
  assert.ok(bytes <= 1000 * MAX_KB);
  assert.ok(zipped <= 1000 * MAX_GZIP_KB);
});

test('the page has no inline script or style, and loads nothing from elsewhere', () => {
  const html = readFileSync(join(page, 'index.html'), 'utf8');
  assert.doesNotMatch(html, /<script(?![^>]*\bsrc=)[^>]*>/);
  assert.doesNotMatch(html, /<style|\sstyle=|\son\w+=/);
  for (const [, address] of html.matchAll(/(?:src|href)="([^"]*)"/g)) assert.match(address, /^(\.\/|#)/);
  for (const file of files(page).filter((name) => name.endsWith('.css'))) assert.doesNotMatch(readFileSync(file, 'utf8'), /@import|url\(/);
});
