// SPDX-License-Identifier: Apache-2.0

export const byId = (id) => document.getElementById(id);

/** An element; text is set as text, never as markup. */
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('aria-')) element.setAttribute(name, value); // false is said, too
    else if (value === null || value === undefined || value === false) continue;
    else if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

const SVG = 'http://www.w3.org/2000/svg';
export function makeSvg(tag, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

const SHAPES = {
  circle: ['circle', { cx: 7, cy: 7, r: 4.4 }],
  triangle: ['path', { d: 'M7 1.6 12.6 11.8H1.4z' }],
  cross: ['path', { d: 'M2.5 2.5l9 9m0-9l-9 9', 'stroke-width': 2.6, stroke: 'currentColor' }],
  square: ['rect', { x: 2.4, y: 2.4, width: 9.2, height: 9.2 }],
};

export function shapeIcon(shape, className) {
  const [tag, attributes] = SHAPES[shape];
  return makeSvg('svg', { viewBox: '0 0 14 14', width: 14, height: 14, class: `shape ${className}`, 'aria-hidden': 'true' },
    makeSvg(tag, attributes));
}
