// SPDX-License-Identifier: Apache-2.0
// Figures for people: three digits and a unit.

const DASH = '–';

function digits(value) {
  const size = Math.abs(value);
  const text = size >= 100 ? value.toFixed(0) : size >= 10 ? value.toFixed(1) : value.toFixed(2);
  return text.includes('.') ? text.replace(/\.?0+$/, '') : text;
}

function scaled(value, units, step) {
  if (value === null || value === undefined || !Number.isFinite(value)) return DASH;
  let unit = 0;
  let rest = value;
  while (Math.abs(rest) >= step && unit < units.length - 1) {
    rest /= step;
    ++unit;
  }
  return `${unit === 0 && Number.isInteger(rest) ? rest : digits(rest)} ${units[unit]}`;
}

export const bytes = (value) => scaled(value, ['B', 'kB', 'MB', 'GB', 'TB'], 1000);
export const rate = (value) => (value ? scaled(Math.round(value), ['B/s', 'kB/s', 'MB/s', 'GB/s'], 1000) : '0 B/s');
export const count = (value) => (Number.isFinite(value) ? value.toLocaleString('en') : DASH);

export function metres(value) {
  if (!Number.isFinite(value)) return DASH;
  const size = Math.abs(value);
  if (size >= 1000) return `${digits(value / 1000)} km`;
  if (size >= 1 || size === 0) return `${digits(value)} m`;
  return size >= 0.01 ? `${(100 * value).toFixed(1)} cm` : `${(1000 * value).toFixed(1)} mm`;
}

export function seconds(value) {
  if (!Number.isFinite(value)) return DASH;
  const size = Math.abs(value);
  if (size >= 3600) return `${Math.floor(value / 3600)} h ${Math.floor((value % 3600) / 60)} min`;
  if (size >= 60) return `${Math.floor(value / 60)} min ${Math.floor(value % 60)} s`;
  if (size >= 1 || size === 0) return `${digits(value)} s`;
  return size >= 1e-3 ? `${digits(1000 * value)} ms` : `${digits(1e6 * value)} µs`;
}

export function ago(milliseconds, now = Date.now()) {
  if (!milliseconds) return DASH;
  const passed = Math.max(0, (now - milliseconds) / 1000);
  if (passed < 5) return 'now';
  if (passed < 60) return `${Math.round(passed)} s ago`;
  if (passed < 3600) return `${Math.round(passed / 60)} min ago`;
  return passed < 86400 ? `${Math.round(passed / 3600)} h ago` : `${Math.round(passed / 86400)} d ago`;
}

export function clock(milliseconds) {
  return milliseconds ? new Date(milliseconds).toLocaleTimeString('en-GB') : DASH;
}

export const words = (name) => name.replaceAll('_', ' ');
