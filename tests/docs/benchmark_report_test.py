#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""benchmark/report.py finds the exponent that is in the results, and changes nothing of a page but what is between its markers; and
each of its curves and tables names benchmarks that there are.

  benchmark_report_test.py SOURCE_DIR [PROGRAM_benchmark...]
"""
import pathlib
import re
import subprocess
import sys
import unittest

source, benchmarks = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:]
sys.path.insert(0, str(source / "benchmark"))
sys.dont_write_bytecode = True
import report  # noqa: E402


def run(name, **values):
    return {"name": name, "run_type": "iteration", **values}


class BenchmarkReport(unittest.TestCase):
    def test_the_exponent_of_a_power_law_is_its_power(self):
        runs = [run(f"BM_X/nodes:{n}/kind:0", cpu_time=3e-4 * n**1.37) for n in (100, 1000, 5000, 20000)]
        curve = report.points({"x": (None, runs)}, "x", r"BM_X/nodes:(\d+)/kind:0", "cpu_time")
        self.assertEqual(list(curve), [100, 1000, 5000, 20000])
        self.assertAlmostEqual(report.exponent(curve), 1.37, places=9)

    def test_one_size_has_no_exponent(self):
        self.assertIsNone(report.exponent({100: 1.0}))

    def test_of_a_size_that_ran_twice_the_smaller_counts(self):
        runs = [run("BM_X/10", p50_ms=4), run("BM_X/10", p50_ms=3), run("BM_Y/10", p50_ms=1)]
        self.assertEqual(report.points({"x": (None, runs)}, "x", r"BM_X/(\d+)$", "p50_ms"), {10: 3})

    def test_only_what_is_between_the_markers_is_written(self):
        page = f"before\n{report.BEGIN}\nold\n{report.END}\nafter\n"
        self.assertEqual(report.between_markers(page, "new\n"), f"before\n{report.BEGIN}\n\nnew\n\n{report.END}\nafter\n")
        with self.assertRaises(SystemExit):
            report.between_markers("no markers", "new")

    def test_the_arguments_are_columns(self):
        self.assertEqual(report.arguments("BM_X/robots:10/own:1/iterations:31/manual_time"), {"robots": "10", "own": "1"})

    @unittest.skipUnless(benchmarks, "the benchmarks are not built")
    def test_every_curve_has_two_sizes_at_least_and_every_table_a_row(self):
        names = {pathlib.Path(program).name.removesuffix("_benchmark"):
                 subprocess.run([program, "--benchmark_list_tests"], check=True, capture_output=True, text=True).stdout.split("\n")
                 for program in benchmarks}
        for figure in report.FIGURES:
            for label, program, pattern, _ in figure[-1]:
                sizes = {match.group(1) for name in names[program] if (match := re.match(pattern, name))}
                self.assertGreaterEqual(len(sizes), 2, f"{figure[0]}: {label}")
        for title, _, program, _ in report.TABLES:
            self.assertTrue(report.arguments(names[program][0]), title)


unittest.main(argv=sys.argv[:1])
