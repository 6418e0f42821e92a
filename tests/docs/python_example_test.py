#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""client/examples/03_python as its head says, against a server: a drifting circle is closed.

  python_example_test.py SOURCE_DIR SERVER
"""
import math
import os
import pathlib
import subprocess
import sys
import tempfile

source, server_program = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
example = source / "client/examples/03_python"
sys.path[:0] = [str(source / "tests/support"), str(example)]
sys.dont_write_bytecode = True
try:
    import grpc  # noqa: F401
except ImportError:
    print("skipped: python3-grpcio is not installed")
    sys.exit(77)
from live_server import live_server  # noqa: E402
from pose import compose, distance, read_tum, write_tum  # noqa: E402

STEPS = 120


def turn(angle):
    return (0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2))


def circle(degrees_per_step):
    pose, rows = ((0.0, 0.0, 0.0), turn(0)), []
    for i in range(STEPS + 1):
        rows.append((1_700_000_000_123_456_789 + i * 10**9, pose))
        pose = compose(pose, ((1.0, 0.0, 0.0), turn(math.radians(degrees_per_step))))
    return rows


def run(work, address):
    command = [str(example / "corrected_trajectory.py"), "odometry.tum", "--server", address, "--closures", "closures.txt",
               "--out", "corrected.tum", "--plot", "plot.svg"]
    return subprocess.run(command, cwd=work, check=True, capture_output=True, text=True, timeout=60,
                          env={**os.environ, "PYTHONPATH": str(work / "stubs"), "PYTHONDONTWRITEBYTECODE": "1"}).stdout


def main():
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        subprocess.run([example / "generate_stubs.sh", work / "stubs"], check=True)
        odometry = circle(360 / STEPS * 1.05)  # measures 5 % too much turn
        write_tum(work / "odometry.tum", odometry)
        (work / "closures.txt").write_text(f"# first and last are one place\n0 {STEPS} 0 0 0 0 0 0 1\n")
        with live_server(server_program, "--data-dir", ":memory:", log=work / "server.log") as address:
            print(run(work, address), end="")
            corrected = read_tum(work / "corrected.tum")
            again = run(work, address)  # nothing is stored twice, nothing refused
        before = distance(odometry[0][1], odometry[-1][1])
        after = distance(corrected[0][1], corrected[-1][1])
        print(f"from end to begin: {before:.3f} m by odometry, {after:.3f} m corrected")
        assert [stamp for stamp, _ in corrected] == [stamp for stamp, _ in odometry]
        assert before > 2 and after < before / 10
        truth = circle(360 / STEPS)
        worst = max(distance(a[1], b[1]) for a, b in zip(corrected, truth))
        print(f"furthest from the truth: {worst:.3f} m")
        assert worst < before / 2
        assert f"{STEPS + 1} poses in 3 submaps, 1 closures" in again
        picture = (work / "plot.svg").read_text()
        assert "<svg" in picture and ("polyline" in picture or "matplotlib" in picture)


main()
