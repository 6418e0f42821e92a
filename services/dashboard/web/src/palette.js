// SPDX-License-Identifier: Apache-2.0
// Colours that people with any kind of colour vision tell apart: verdicts after Okabe & Ito (Color Universal Design, 2008), robots
// after Tol's muted scheme (SRON/EPS/TN/09-002), its reds left out since they say "refused" here. Every verdict also has a shape and a dash.

const ROBOTS = {
  light: ['#0072b2', '#117733', '#aa4499', '#3f8fb5', '#8a7a1f', '#44aa99', '#332288', '#6b6b6b'],
  dark: ['#56a5e0', '#5fbf77', '#d48cc6', '#88ccee', '#ddcc77', '#44c2ac', '#9b90e8', '#b5b5b5'],
};

export const VERDICT_GROUPS = [
  { key: 'used', name: 'used', shape: 'circle', dash: null, verdicts: ['accepted', 'forced_by_operator'] },
  { key: 'waiting', name: 'waiting', shape: 'triangle', dash: [6, 4], verdicts: ['pending', 'quarantined', 'unspecified'] },
  { key: 'refused', name: 'refused', shape: 'cross', dash: [2, 4],
    verdicts: ['demoted_by_optimiser', 'rejected_score', 'rejected_overlap', 'rejected_residual', 'rejected_degenerate', 'rejected_inconsistent'] },
  { key: 'vetoed', name: 'vetoed', shape: 'square', dash: [9, 3], verdicts: ['vetoed_by_operator'] },
];
const GROUP_OF = new Map(VERDICT_GROUPS.flatMap((group) => group.verdicts.map((verdict) => [verdict, group.key])));

/** What a newer server may say counts as waiting: it is not in use. */
export function verdictGroup(verdict) {
  return GROUP_OF.get(verdict) ?? 'waiting';
}

const VERDICT_COLOURS = {
  light: { used: '#2b3640', waiting: '#b87a00', refused: '#a8320a', vetoed: '#8b3f73' },
  dark: { used: '#e8edf2', waiting: '#e69f00', refused: '#f0622b', vetoed: '#cc79a7' },
};

// From the ground's own colour to full, lightness strictly monotone: read without any hue.
const HEAT_STOPS = {
  light: ['#dfe3e6', '#f2c46d', '#d9782d', '#9c2f1a', '#4d0b12'],
  dark: ['#39434c', '#7a4a3a', '#c86a2c', '#f0a830', '#fff0a8'],
};

export function parseColour(hex) {
  const value = parseInt(hex.slice(1), 16);
  return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}

export function mix(a, b, share) {
  return a.map((value, i) => value + share * (b[i] - value));
}

/** `share` in [0, 1]; beyond it the end's colour. NaN: the lowest. */
export function heatColour(theme, share) {
  const stops = HEAT_STOPS[theme].map(parseColour);
  const at = Math.min(Math.max(share || 0, 0), 1) * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2);
  return mix(stops[low], stops[low + 1], at - low);
}

const TABLE_SIZE = 256;

/** The same for many values: a function of `share`, from a table. */
export function heatScale(theme) {
  const table = Array.from({ length: TABLE_SIZE }, (_, i) => heatColour(theme, i / (TABLE_SIZE - 1)));
  return (share) => table[Math.round(Math.min(Math.max(share || 0, 0), 1) * (TABLE_SIZE - 1))];
}

export function heatGradient(theme) {
  return HEAT_STOPS[theme];
}

export function robotColour(theme, ordinal) {
  return ROBOTS[theme][ordinal % ROBOTS[theme].length];
}

export function verdictColour(theme, group) {
  return VERDICT_COLOURS[theme][group];
}

export const GROUND = { light: '#f4f6f8', dark: '#11161b' };
export const UNANCHORED = { light: '#7a858f', dark: '#8b97a3' };
export const CONSTRAINT = { light: '#0a7f9e', dark: '#4fd0f0' };
