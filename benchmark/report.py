#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""From Google Benchmark's JSON to tables, exponents and log-log plots.

    report.py RESULTS --plots DIR [--readme FILE]     RESULTS: the folder into which run.sh put PROGRAM.json

Without --readme the report goes to standard output. An exponent is the slope of a least-squares line through the logarithms of all
sizes of a curve."""
import argparse
import json
import math
import os
import pathlib
import re

BEGIN = '<!-- benchmark/run.sh writes from here -->'
END = '<!-- to here -->'

# A figure: file, title, what its size is, unit of its values, what is to be held; and its curves: label, program, the names of its
# benchmarks (the group is the size), value.
FIGURES = [
    ('client', 'One comparison on the robot', 'nodes', 'ms', '15 ms at 1,000 nodes, 250 ms at 10,000', [
        ('`distance` signal', 'trajectory_comparison', r'BM_CompareTrajectories/nodes:(\d+)/se3_log:0', 'cpu_time'),
        ('its next revision', 'trajectory_comparison', r'BM_CompareNextRevision/nodes:(\d+)/se3_log:0', 'cpu_time'),
        ('`se3_log` signal', 'trajectory_comparison', r'BM_CompareTrajectories/nodes:(\d+)/se3_log:1', 'cpu_time'),
        ('its next revision (`se3_log`)', 'trajectory_comparison', r'BM_CompareNextRevision/nodes:(\d+)/se3_log:1', 'cpu_time')]),
    ('estimator', 'A batch of 15 constraints into the onboard estimator', 'poses', 'ms',
     '3 / 15 / 60 ms at 1,000 / 5,000 / 20,000 poses', [
         ('first batch', 'onboard_estimator', r'BM_ApplyFifteenConstraints/poses:(\d+)/constraints_before:0', 'cpu_time'),
         ('with 300 chords there', 'onboard_estimator', r'BM_ApplyFifteenConstraints/poses:(\d+)/constraints_before:300', 'cpu_time')]),
    ('cycle', 'The server\'s cycle, ten robots', 'keyframes', 'ms of all threads', 'cost within 1e-6 of the batch optimum', [
        ('p50, one thread', 'map_cycle', r'BM_Cycle/robots:10/keyframes:(\d+)/threads:1/', 'p50_cpu_ms'),
        ('p99, one thread', 'map_cycle', r'BM_Cycle/robots:10/keyframes:(\d+)/threads:1/', 'p99_cpu_ms'),
        ('p50, two threads', 'map_cycle', r'BM_Cycle/robots:10/keyframes:(\d+)/threads:2/', 'p50_cpu_ms'),
        ('p99, two threads', 'map_cycle', r'BM_Cycle/robots:10/keyframes:(\d+)/threads:2/', 'p99_cpu_ms'),
        ('batch Ceres', 'map_cycle', r'BM_Cycle/robots:10/keyframes:(\d+)/threads:1/', 'batch_cpu_ms')]),
    ('memory', 'Memory of a map, ten robots', 'keyframes', 'bytes a keyframe', '', [
        ('map', 'map_cycle', r'BM_Cycle/robots:10/keyframes:(\d+)/threads:1/', 'map_bytes'),
        ('each further snapshot', 'map_cycle', r'BM_Cycle/robots:10/keyframes:(\d+)/threads:1/', 'snapshot_bytes')]),
    ('spectral', 'Graph and filters', 'nodes', 'ms', '', [
        ('radius graph', 'spectral', r'BM_RadiusGraph/(\d+)$', 'cpu_time'),
        ('largest eigenvalue', 'spectral', r'BM_LargestEigenvalue/(\d+)$', 'cpu_time'),
        ('exact filter', 'spectral', r'BM_ExactFilter/(\d+)$', 'cpu_time'),
        ('Krylov filter', 'spectral', r'BM_KrylovFilter/(\d+)$', 'cpu_time'),
        ('Chebyshev filter', 'spectral', r'BM_ChebyshevFilter/(\d+)$', 'cpu_time')]),
    ('reduction', 'Reduction to 60 % of the nodes, one core', 'nodes', 'ms', '', [
        ('choosing the nodes', 'spectral', r'BM_SelectNodes/(\d+)$', 'cpu_time'),
        ('Kron reduction, exact', 'spectral', r'BM_KronExact/(\d+)$', 'cpu_time'),
        ('Kron reduction, sparsified', 'spectral', r'BM_KronSparsified/(\d+)$', 'cpu_time'),
        ('choosing and sparsified', 'spectral', r'BM_Reduction/(\d+)$', 'cpu_time')]),
    ('fan_out_watchers', 'Fan-out of 2,000 nodes, whole map', 'watchers', 'ms', '100 ms at 500 watchers', [
        ('the last watcher, p50', 'fan_out', r'BM_FanOut/watchers:(\d+)/nodes:2000/keyframes:2000/own:0', 'p50_ms'),
        ('the last watcher, max', 'fan_out', r'BM_FanOut/watchers:(\d+)/nodes:2000/keyframes:2000/own:0', 'max_ms'),
        ('the first watcher, p50', 'fan_out', r'BM_FanOut/watchers:(\d+)/nodes:2000/keyframes:2000/own:0', 'first_ms')]),
    ('fan_out_nodes', 'Fan-out to 500 watchers, whole map', 'nodes', 'ms', '', [
        ('the last watcher, p50', 'fan_out', r'BM_FanOut/watchers:500/nodes:(\d+)/keyframes:\1/own:0', 'p50_ms'),
        ('the first watcher, p50', 'fan_out', r'BM_FanOut/watchers:500/nodes:(\d+)/keyframes:\1/own:0', 'first_ms')]),
]

# A table of its own: title, what is to be held, program, counters with their headings. The benchmarks' arguments come first.
TABLES = [
    ('The server\'s cycle, in full', 'cost within 1e-6 of the batch optimum', 'map_cycle',
     [('p50 ms', 'p50_ms'), ('p99 ms', 'p99_ms'), ('p50 CPU ms', 'p50_cpu_ms'), ('p99 CPU ms', 'p99_cpu_ms'), ('batch CPU ms', 'batch_cpu_ms'),
      ('cost above batch', 'cost_above_batch'), ('map, B a keyframe', 'map_bytes'), ('snapshot, B a keyframe', 'snapshot_bytes'), ('heap MB', 'heap_MB')]),
    ('Fan-out, in full', '500 watchers of 2,000 nodes within 100 ms', 'fan_out',
     [('first ms', 'first_ms'), ('last p50 ms', 'p50_ms'), ('last max ms', 'max_ms'), ('frame bytes', 'bytes'), ('is a delta', 'delta')]),
    ('Downlink', '5 KB/s for each robot, a 2,000-node graph refreshed every 20 s', 'downlink',
     [('revisions/s', 'revisions_per_s'), ('snapshot bytes', 'snapshot_bytes'), ('delta bytes', 'delta_bytes'), ('bytes/s', 'bytes_per_s'),
      ('building ms', 'real_time')]),
    ('Upload', 'a share of 0.6', 'upload_throughput',
     [('MB', 'MB'), ('server MB/s', 'server_MBps'), ('bare stream MB/s', 'bare_MBps'), ('write and fsync MB/s', 'write_MBps'), ('share', 'share')]),
]


def load(folder):
    """PROGRAM -> its results, and where and when they were measured."""
    programs = {}
    for file in sorted(pathlib.Path(folder).glob('*.json')):
        result = json.loads(file.read_text())
        runs = [run for run in result['benchmarks'] if run.get('run_type') != 'aggregate']
        failed = [run['name'] for run in runs if run.get('error_occurred')]
        if failed:
            raise SystemExit(f'{file}: failed: {", ".join(failed)}')
        programs[file.stem] = (result['context'], runs)
    return programs


def points(programs, program, pattern, value):
    """Size -> value; of a size that was run more than once the smallest."""
    found = {}
    for run in programs.get(program, (None, []))[1]:
        match = re.match(pattern, run['name'])
        if match and run.get(value, 0) > 0:
            size = int(match.group(1))
            found[size] = min(run[value], found.get(size, math.inf))
    return dict(sorted(found.items()))


def exponent(curve):
    """Slope of log value over log size; None below two sizes."""
    if len(curve) < 2:
        return None
    x = [math.log(size) for size in curve]
    y = [math.log(value) for value in curve.values()]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def number(value):
    """Three digits that count, thousands apart."""
    if value is None:
        return ''
    if value == 0 or 1e-3 <= abs(value) < 1000:
        return f'{value:.3g}'
    return f'{value:,.0f}' if abs(value) >= 1000 else f'{value:.1e}'


def row(cells):
    return '| ' + ' | '.join(cells) + ' |'


def table(head, rows):
    return '\n'.join([row(head), '|' + '---|' * len(head), *map(row, rows)])


def figure_section(figure, curves, plot):
    _, title, size_name, unit, aim, _ = figure
    sizes = sorted({size for curve in curves.values() for size in curve})
    rows = []
    for label, curve in curves.items():
        slope = exponent(curve)
        rows.append([label, *(number(curve.get(size)) for size in sizes), '' if slope is None else f'N^{slope:.2f}'])
    to_hold = f' To hold: {aim}.' if aim else ''
    return f'### {title}\n\nIn {unit}.{to_hold}\n\n{table([size_name, *(f"{size:,}" for size in sizes), "growth"], rows)}\n\n![{title}]({plot})\n'


def arguments(name):
    """'BM_X/robots:10/iterations:5/manual_time' -> {'robots': '10'}"""
    pairs = [part.split(':') for part in name.split('/') if ':' in part]
    return {key: value for key, value in pairs if key not in ('iterations', 'repeats')}


def table_section(title, aim, runs, columns):
    names = list(arguments(runs[0]['name']))
    rows = [[*(f'{int(arguments(run["name"])[name]):,}' for name in names), *(number(run.get(key)) for _, key in columns)] for run in runs]
    return f'### {title}\n\nTo hold: {aim}.\n\n{table([*names, *(heading for heading, _ in columns)], rows)}\n'


def draw(file, figure, curves):
    import matplotlib
    matplotlib.use('svg')
    # The same results give the same file; letters stay letters, which is smaller.
    matplotlib.rcParams.update({'svg.hashsalt': 'overtone', 'svg.fonttype': 'none', 'font.size': 9})
    from matplotlib import pyplot
    _, title, size_name, unit, _, _ = figure
    canvas, axes = pyplot.subplots(figsize=(5.6, 3.4))
    for (label, curve), marker in zip(curves.items(), 'osD^vP'):
        slope = exponent(curve)
        shown = label.replace('`', '') + ('' if slope is None else f': N^{slope:.2f}')
        axes.loglog(list(curve), list(curve.values()), marker=marker, markersize=4, linewidth=1.2, label=shown)
    axes.set(title=title, xlabel=size_name, ylabel=unit)
    axes.grid(True, which='major', linewidth=0.4)
    axes.legend(fontsize=7)
    canvas.tight_layout()
    canvas.savefig(file, metadata={'Date': None, 'Creator': None})
    pyplot.close(canvas)


def measured(programs):
    """The machine and its load, for each program: what a number is worth."""
    lines = []
    for program, (context, _) in sorted(programs.items()):
        load_average = ', '.join(f'{load:.1f}' for load in context.get('load_avg', []))
        lines.append(f'`{program}` {context["date"][:16]} (load {load_average})')
    cores = max(context['num_cpus'] for context, _ in programs.values())
    return f'{cores} cores; when each began, and the load of the machine over 1, 5 and 15 minutes then: {"; ".join(lines)}.\n'


def report(programs, plots, plot_prefix):
    sections = [measured(programs)]
    for figure in FIGURES:
        curves = {label: points(programs, *where) for label, *where in figure[-1]}
        curves = {label: curve for label, curve in curves.items() if curve}
        if not curves:
            continue
        file = f'{figure[0]}.svg'
        draw(plots / file, figure, curves)
        sections.append(figure_section(figure, curves, plot_prefix + file))
    for title, aim, program, columns in TABLES:
        runs = programs.get(program, (None, []))[1]
        if runs:
            sections.append(table_section(title, aim, runs, columns))
    return '\n'.join(sections)


def between_markers(text, new):
    before, found_begin, rest = text.partition(BEGIN)
    _, found_end, after = rest.partition(END)
    if not found_begin or not found_end:
        raise SystemExit(f'the page lacks the lines "{BEGIN}" and "{END}"')
    return f'{before}{BEGIN}\n\n{new}\n{END}{after}'


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('results', type=pathlib.Path)
    parser.add_argument('--plots', type=pathlib.Path, required=True)
    parser.add_argument('--readme', type=pathlib.Path)
    options = parser.parse_args()
    programs = load(options.results)
    if not programs:
        raise SystemExit(f'{options.results}: no results')
    options.plots.mkdir(parents=True, exist_ok=True)
    if options.readme:
        prefix = os.path.relpath(options.plots, options.readme.parent) + '/'
        text = report(programs, options.plots, prefix)
        options.readme.write_text(between_markers(options.readme.read_text(), text))
    else:
        print(report(programs, options.plots, ''), end='')


if __name__ == '__main__':
    main()
