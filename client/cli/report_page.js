// SPDX-License-Identifier: Apache-2.0
// Draws the report's plots from the JSON that report_data.cc wrote. No library, no network.
'use strict';

const SVG = 'http://www.w3.org/2000/svg';
const data = JSON.parse(document.getElementById('data').textContent);

const ROBOT_COLOURS = ['#e69f00', '#0f8fd6', '#cc79a7', '#009e73', '#56b4e9', '#d55e00'];
const TRUTH = {key: 'truth', label: 'ground truth', colour: 'var(--truth)', style: 'truth'};
const ONBOARD = {key: 'onboard', label: 'onboard (odometry)', colour: 'var(--onboard)', style: 'dashed'};
const SERVER = {key: 'server', label: 'server', colour: 'var(--server)', style: ''};
const CORRECTED = {key: 'corrected', label: 'corrected', colour: 'var(--corrected)', style: ''};
// The estimate to look at: a server's map knows of no corrected one.
const BEST = data.live ? SERVER : CORRECTED;
const KINDS = {
  small: 'small (neighbours)', mid: 'mid (hops)', large: 'large (submaps)',
  degenerate: 'degenerate', chord: 'chord (knots)',
};
const BANDS = ['large scale', 'mid scale', 'small scale'];
const VIRIDIS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

// ---- small helpers ----

function add(parent, tag, attributes = {}, text) {
  const node = document.createElementNS(parent.namespaceURI === SVG || tag === 'svg' ? SVG : parent.namespaceURI, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  if (text !== undefined) node.textContent = text;
  parent.appendChild(node);
  return node;
}

const isNumber = (value) => typeof value === 'number';

// [lowest, highest] of the numbers in the lists, [0, 1] when there are none.
function rangeOf(...lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) {
    for (const value of list) {
      if (!isNumber(value)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  return low <= high ? [low, high] : [0, 1];
}

// About `count` round numbers between low and high.
function ticks(low, high, count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= raw * 0.999);
  const list = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + step * 1e-9; i++) list.push(i * step);
  return {list, text: (value) => value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)))};
}

// ---- a chart: frame, axes, scales, tip ----

class Chart {
  // x, y: data ranges. equal: one metre is as long on both axes. yTicks: {list, text} of one's own.
  constructor(host, {width, height, x, y, xLabel, yLabel, name, equal = false, yTicks}) {
    this.host = host;
    this.box = {left: 58, top: 12, right: width - 14, bottom: height - 44};
    const w = this.box.right - this.box.left, h = this.box.bottom - this.box.top;
    [this.x, this.y] = equal ? Chart.equalise(x, y, w, h) : [x, y];
    if (this.x[0] === this.x[1]) this.x = [this.x[0] - 0.5, this.x[1] + 0.5];
    if (this.y[0] === this.y[1]) this.y = [this.y[0], this.y[1] + 1];
    this.sx = (v) => this.box.left + (v - this.x[0]) / (this.x[1] - this.x[0]) * w;
    this.sy = (v) => this.box.bottom - (v - this.y[0]) / (this.y[1] - this.y[0]) * h;
    this.svg = add(host, 'svg', {class: 'chart', viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': name});
    this.drawAxes(xLabel, yLabel, width, height, yTicks);
    const id = `clip${Chart.count = (Chart.count || 0) + 1}`;
    const clip = add(add(this.svg, 'clipPath', {id}), 'rect');
    for (const [k, v] of Object.entries({x: this.box.left, y: this.box.top, width: w, height: h})) clip.setAttribute(k, v);
    this.plot = add(this.svg, 'g', {'clip-path': `url(#${id})`});
    this.tip = add(host, 'div', {class: 'tip hidden'});
    this.svg.addEventListener('pointerleave', () => this.hideTip());
  }

  // Both ranges widened about their middle to one scale, with a margin of a twentieth.
  static equalise(x, y, w, h) {
    const perPixel = 1.1 * Math.max((x[1] - x[0]) / w, (y[1] - y[0]) / h, 1e-3);
    const around = (range, size) => {
      const middle = (range[0] + range[1]) / 2;
      return [middle - perPixel * size / 2, middle + perPixel * size / 2];
    };
    return [around(x, w), around(y, h)];
  }

  drawAxes(xLabel, yLabel, width, height, yTicks) {
    const {left, top, right, bottom} = this.box;
    const xTicks = ticks(...this.x, (right - left) / 70);
    for (const value of xTicks.list) {
      add(this.svg, 'line', {class: 'grid', x1: this.sx(value), x2: this.sx(value), y1: top, y2: bottom});
      add(this.svg, 'text', {x: this.sx(value), y: bottom + 17, 'text-anchor': 'middle'}, xTicks.text(value));
    }
    const rows = yTicks || ticks(...this.y, (bottom - top) / 36);
    for (const value of rows.list) {
      if (!yTicks) add(this.svg, 'line', {class: 'grid', x1: left, x2: right, y1: this.sy(value), y2: this.sy(value)});
      add(this.svg, 'text', {x: left - 7, y: this.sy(value) + 4, 'text-anchor': 'end'}, rows.text(value));
    }
    add(this.svg, 'rect', {class: 'frame', x: left, y: top, width: right - left, height: bottom - top});
    add(this.svg, 'text', {class: 'label', x: (left + right) / 2, y: height - 8, 'text-anchor': 'middle'}, xLabel);
    const middle = (top + bottom) / 2;
    add(this.svg, 'text', {class: 'label', x: 14, y: middle, 'text-anchor': 'middle', transform: `rotate(-90 14 ${middle})`}, yLabel);
  }

  // points: x, y, x, y, ...; null breaks the line.
  trace(points, {key, colour, style}) {
    let path = '', pen = false;
    for (let i = 0; i < points.length; i += 2) {
      const drawn = isNumber(points[i]) && isNumber(points[i + 1]);
      if (drawn) path += `${pen ? 'L' : 'M'}${this.sx(points[i]).toFixed(1)} ${this.sy(points[i + 1]).toFixed(1)}`;
      pen = drawn;
    }
    add(this.plot, 'path', {class: `trace ${style}`, d: path, stroke: colour, 'data-key': key});
  }

  // A dot where the line begins.
  mark(points, {key, colour}) {
    const start = points.findIndex((value, i) => i % 2 === 0 && isNumber(value));
    if (start < 0) return;
    const dot = add(this.plot, 'circle', {cx: this.sx(points[start]), cy: this.sy(points[start + 1]), r: 4, fill: colour, 'data-key': key});
    add(dot, 'title', {}, 'start');
  }

  // Where the pointer is, in the chart's own units.
  pointer(event) {
    const rectangle = this.svg.getBoundingClientRect();
    const scale = this.svg.viewBox.baseVal.width / rectangle.width;
    return {x: (event.clientX - rectangle.left) * scale, y: (event.clientY - rectangle.top) * scale};
  }

  showTip(event, text) {
    const host = this.host.getBoundingClientRect();
    const x = event.clientX - host.left;
    this.tip.textContent = text;
    this.tip.classList.remove('hidden');
    this.tip.style.left = `${x > host.width / 2 ? x - this.tip.offsetWidth - 12 : x + 12}px`;
    this.tip.style.top = `${event.clientY - host.top + 12}px`;
  }

  hideTip() { this.tip.classList.add('hidden'); }
}

// Check boxes that show and hide everything with their key in the given charts.
function legend(host, items, charts) {
  for (const item of items) {
    const label = add(host, 'label');
    const box = add(label, 'input', {type: 'checkbox'});
    box.checked = true;
    const swatch = add(label, 'svg', {viewBox: '0 0 26 10', 'aria-hidden': 'true'});
    add(swatch, 'line', {class: `trace ${item.style || ''}`, x1: 1, x2: 25, y1: 5, y2: 5, stroke: item.colour});
    add(label, 'span', {}, item.label);
    box.addEventListener('change', () => {
      for (const chart of charts) {
        for (const node of chart.plot.querySelectorAll('[data-key]')) {
          if (node.dataset.key === item.key) node.classList.toggle('hidden', !box.checked);
        }
      }
    });
  }
  if (items.length === 0) add(host, 'span', {class: 'empty'}, 'none');
}

const isShown = (chart, key) => !Array.from(chart.plot.querySelectorAll('[data-key]')).some((node) => node.dataset.key === key && node.classList.contains('hidden'));

// ---- trajectories from above ----

const evens = (points) => points.filter((_, i) => i % 2 === 0);
const odds = (points) => points.filter((_, i) => i % 2 === 1);

function topView(host, paths, name, height = 440) {
  return new Chart(host, {
    width: 580, height, equal: true, name,
    x: rangeOf(...paths.map(evens)), y: rangeOf(...paths.map(odds)),
    xLabel: `${data.axes[0]} [m]`, yLabel: `${data.axes[1]} [m]`,
  });
}

// Names the keyframe next to the pointer. lines: [{key, label, robot, points}].
function hoverKeyframes(chart, lines) {
  chart.svg.addEventListener('pointermove', (event) => {
    if (event.target.closest('.chords')) return;  // has a title of its own
    const at = chart.pointer(event);
    let best = null, nearest = 14;
    for (const line of lines) {
      if (!isShown(chart, line.key)) continue;
      for (let i = 0; i < line.points.length; i += 2) {
        if (!isNumber(line.points[i])) continue;
        const distance = Math.hypot(chart.sx(line.points[i]) - at.x, chart.sy(line.points[i + 1]) - at.y);
        if (distance < nearest) [nearest, best] = [distance, {line, i}];
      }
    }
    if (!best) return chart.hideTip();
    const {line, i} = best;
    chart.showTip(event, `${line.robot.name} · ${line.label}\nkeyframe ${line.robot.keyframes[i / 2]}, ${line.robot.time[i / 2].toFixed(1)} s\n${data.axes[0]} ${line.points[i]} m, ${data.axes[1]} ${line.points[i + 1]} m`);
  });
}

function chord(group, chart, [x1, y1, x2, y2], attributes, title) {
  if (![x1, y1, x2, y2].every(isNumber)) return;
  const line = add(group, 'line', {...attributes, x1: chart.sx(x1), y1: chart.sy(y1), x2: chart.sx(x2), y2: chart.sy(y2)});
  add(line, 'title', {}, title);
}

function drawTeam() {
  const team = data.robots.filter((robot) => robot.drawnWithTeam);
  const all = team.flatMap((robot) => Object.values(robot.paths));
  const colour = (i) => ROBOT_COLOURS[i % ROBOT_COLOURS.length];
  const dash = (i) => i < ROBOT_COLOURS.length ? '' : 'dashed';
  const charts = [['team-before', 'onboard', 'Onboard estimates'], ['team-after', BEST.key, data.live ? 'Estimates of the server' : 'Corrected estimates']].map(([id, estimate, name]) => {
    const chart = topView(document.getElementById(id), all, `${name} of all robots, seen from above`);
    const lines = [];
    for (const robot of team) chart.trace(robot.paths.truth, TRUTH);
    team.forEach((robot, i) => {
      const key = `robot ${i}`;
      const look = {key, colour: colour(i), style: dash(i)};
      chart.trace(robot.paths[estimate], look);
      chart.mark(robot.paths[estimate], look);
      lines.push({key, label: estimate, robot, points: robot.paths[estimate]});
    });
    hoverKeyframes(chart, lines);
    return chart;
  });
  const items = team.map((robot, i) => ({key: `robot ${i}`, label: robot.name, colour: colour(i), style: dash(i)}));
  if (data.robots.some((robot) => robot.paths.truth.some(isNumber))) items.push(TRUTH);
  legend(document.getElementById('team-legend'), items.concat(drawClosures(charts[1])), charts);
}

// Loop closures between the places they tie, on the map after correction; returns what the legend needs.
function drawClosures(chart) {
  const verdicts = new Map();
  for (const [verdict, outlier, from, to, ...ends] of data.closures) {
    const colour = verdict === 'accepted' ? 'var(--accepted)' : 'var(--refused)';
    if (!verdicts.has(verdict)) {
      verdicts.set(verdict, {key: `closure ${verdict}`, label: `closures: ${verdict.replace(/_/g, ' ')}`, colour, group: add(chart.plot, 'g', {class: 'chords', 'data-key': `closure ${verdict}`})});
    }
    chord(verdicts.get(verdict).group, chart, ends, {stroke: colour}, `closure ${from} → ${to}: ${verdict.replace(/_/g, ' ')}${outlier ? ' (wrong on purpose)' : ''}`);
  }
  return Array.from(verdicts.values()).sort((a, b) => a.key < b.key ? -1 : 1);
}

// ---- one robot ----

function drawTrajectories(section, robot) {
  const hasTruth = robot.paths.truth.some(isNumber);
  const chart = topView(section.querySelector('.trajectories'), Object.values(robot.paths), `Trajectories of ${robot.name}, seen from above`);
  const estimates = [...(hasTruth ? [TRUTH] : []), ONBOARD, SERVER, ...(data.live ? [] : [CORRECTED])];
  for (const estimate of estimates) chart.trace(robot.paths[estimate.key], estimate);
  for (const estimate of estimates) chart.mark(robot.paths[estimate.key], estimate);
  hoverKeyframes(chart, estimates.map((e) => ({...e, robot, points: robot.paths[e.key]})));
  legend(section.querySelector('.estimates'), estimates, [chart]);
}

function drawConstraints(section, robot) {
  const chart = topView(section.querySelector('.constraints'), Object.values(robot.paths), `Constraints of ${robot.name} on its ${data.live ? '' : 'corrected '}trajectory`);
  chart.trace(robot.paths[BEST.key], {key: 'path', colour: 'var(--truth)', style: ''});
  const groups = {};
  // Long ones first, so that short ones lie on top.
  for (const kind of ['chord', 'large', 'degenerate', 'mid', 'small']) groups[kind] = add(chart.plot, 'g', {class: 'chords', 'data-key': kind});
  const count = {};
  for (const [kind, from, to, score, ...ends] of robot.constraints) {
    count[kind] = (count[kind] || 0) + 1;
    chord(groups[kind], chart, ends, {stroke: `var(--${kind})`}, `${kind}: keyframe ${from} → ${to}, score ${score}`);
  }
  const items = Object.keys(KINDS).filter((kind) => count[kind]).map((kind) => ({key: kind, label: KINDS[kind], colour: `var(--${kind})`}));
  legend(section.querySelector('.kinds'), items, [chart]);
  if (data.live) section.querySelector('.constraints').parentNode.querySelector('figcaption').firstChild.textContent = 'Constraints of the last comparison ';
  const drawn = robot.constraints.length, total = robot.constraintCount;
  section.querySelector('.constraints').parentNode.querySelector('small').textContent =
    drawn < total ? `${drawn} of ${total} drawn` : `${total}`;
}

// Lines over time; false when there is nothing to draw.
function drawOverTime(figure, series, estimates, name, yLabel) {
  const present = estimates.filter((e) => series[e.key] && series[e.key].some(isNumber));
  if (present.length === 0 || series.time.length < 2) return figure.remove();
  const chart = new Chart(figure.querySelector('.plot'), {
    width: 1190, height: 230, name, x: rangeOf(series.time), y: [0, rangeOf(...present.map((e) => series[e.key]))[1] * 1.05],
    xLabel: 'time since the first keyframe [s]', yLabel,
  });
  for (const e of present) chart.trace(series.time.flatMap((t, i) => [t, series[e.key][i]]), e);
  legend(figure.querySelector('.legend'), present, [chart]);
  const cursor = add(chart.plot, 'line', {class: 'cursor hidden', y1: chart.box.top, y2: chart.box.bottom});
  chart.svg.addEventListener('pointerleave', () => cursor.classList.add('hidden'));
  chart.svg.addEventListener('pointermove', (event) => {
    const x = chart.pointer(event).x;
    let i = 0;
    series.time.forEach((t, k) => { if (Math.abs(chart.sx(t) - x) < Math.abs(chart.sx(series.time[i]) - x)) i = k; });
    cursor.classList.remove('hidden');
    for (const end of ['x1', 'x2']) cursor.setAttribute(end, chart.sx(series.time[i]));
    const values = present.filter((e) => isNumber(series[e.key][i])).map((e) => `${e.label}: ${series[e.key][i].toFixed(3)} m`);
    chart.showTip(event, [`${series.time[i].toFixed(1)} s`, ...values].join('\n'));
  });
}

function viridis(share) {
  const at = Math.min(share, 0.9999) * (VIRIDIS.length - 1), k = Math.floor(at);
  return VIRIDIS[k].map((c, i) => Math.round(c + (at - k) * (VIRIDIS[k + 1][i] - c)));
}

// One pixel per cell, the first row at the bottom.
function heatImage(cells, columns, rows) {
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [columns, rows];
  const context = canvas.getContext('2d');
  for (let i = 0; i < cells.length; i++) {
    if (cells[i] === ' ') continue;
    context.fillStyle = `rgb(${viridis(data.levels.indexOf(cells[i]) / 63)})`;
    context.fillRect(i % columns, rows - 1 - Math.floor(i / columns), 1, 1);
  }
  return canvas.toDataURL();
}

function drawHeat(figure, robot) {
  const {columns, max, time, cells} = robot.heat;
  if (!columns) return figure.remove();
  const plot = figure.querySelector('.plot');
  const panels = add(plot, 'div', {class: 'triple'});
  const rows = ticks(0, time.length, 5).list.filter((i) => Number.isInteger(i) && i < time.length);
  BANDS.forEach((band, b) => {
    const cell = add(panels, 'div');
    add(cell, 'div', {class: 'band'}, band);
    const host = add(cell, 'div', {class: 'plot'});
    const chart = new Chart(host, {
      width: 390, height: 230, name: `Discrepancy of ${robot.name}, ${band}`, x: [0, robot.pathLength], y: [-0.5, time.length - 0.5],
      xLabel: 'along the path [m]', yLabel: b === 0 ? 'comparison at [s]' : '', yTicks: {list: rows, text: (i) => time[i].toFixed(0)},
    });
    const {left, top, right, bottom} = chart.box;
    add(chart.plot, 'image', {href: heatImage(cells[b], columns, time.length), x: left, y: top, width: right - left, height: bottom - top, preserveAspectRatio: 'none', style: 'image-rendering: pixelated'});
    chart.svg.addEventListener('pointermove', (event) => {
      const at = chart.pointer(event);
      const column = Math.floor((at.x - left) / (right - left) * columns);
      const row = Math.floor((bottom - at.y) / (bottom - top) * time.length);
      const level = cells[b][row * columns + column];
      if (column < 0 || column >= columns || row < 0 || row >= time.length || level === ' ') return chart.hideTip();
      const value = (data.levels.indexOf(level) / 63) ** 2 * max;
      chart.showTip(event, `${(column / columns * robot.pathLength).toFixed(0)} m along the path\ncomparison at ${time[row].toFixed(0)} s\ndiscrepancy ${value.toPrecision(2)}`);
    });
  });
  const key = add(plot, 'div', {class: 'scale'});
  add(key, 'span', {}, '0');
  add(key, 'i', {style: `background:linear-gradient(90deg,${VIRIDIS.map((c) => `rgb(${c})`)})`});
  add(key, 'span', {}, `${max.toPrecision(3)} (units of the signal; colour by square root)`);
}

function drawRobot(robot) {
  const section = document.getElementById('robot').content.firstElementChild.cloneNode(true);
  section.querySelector('h2').textContent = robot.drawnWithTeam ? robot.name : `${robot.name} (unanchored: in a frame of its own)`;
  document.getElementById('robots').appendChild(section);
  if (robot.keyframes.length === 0) {
    for (const figure of section.querySelectorAll('figure')) figure.remove();
    return add(section, 'p', {}, 'No keyframes.');
  }
  drawTrajectories(section, robot);
  drawConstraints(section, robot);
  drawOverTime(section.querySelector('.errors'), robot.errors, [ONBOARD, SERVER, CORRECTED], `Position error of ${robot.name} over time`, 'error [m]');
  drawOverTime(section.querySelector('.running'), robot.running, [ONBOARD, CORRECTED], `RMSE of ${robot.name} while it drove`, 'RMSE [m]');
  drawHeat(section.querySelector('.heat'), robot);
}

if (data.robots.length === 0) {
  document.getElementById('team').remove();
} else {
  drawTeam();
  data.robots.forEach(drawRobot);
}
