# SPDX-License-Identifier: Apache-2.0
"""Rigid transforms as ((x, y, z), (qx, qy, qz, qw)); a_tform_b takes a point of frame b to frame a."""
import math

IDENTITY = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def quaternion_product(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def rotate(q, v):
    x, y, z, _ = quaternion_product(quaternion_product(q, (*v, 0.0)), (-q[0], -q[1], -q[2], q[3]))
    return (x, y, z)


def compose(a_tform_b, b_tform_c):
    moved = rotate(a_tform_b[1], b_tform_c[0])
    return (tuple(p + m for p, m in zip(a_tform_b[0], moved)), quaternion_product(a_tform_b[1], b_tform_c[1]))


def inverse(a_tform_b):
    x, y, z, w = a_tform_b[1]
    q = (-x, -y, -z, w)
    return (tuple(-c for c in rotate(q, a_tform_b[0])), q)


def distance(a, b):
    return math.dist(a[0], b[0])


def read_tum(path):
    """[(stamp_ns, pose)] of rows "t x y z qx qy qz qw", quaternions made unit."""
    rows = []
    with open(path, encoding="ascii") as file:
        for number, line in enumerate(file, 1):
            if not line.strip() or line.startswith("#"):
                continue
            words = line.split()
            if len(words) != 8:
                raise ValueError(f"{path}:{number}: 8 numbers expected, not {len(words)}")
            seconds, _, fraction = words[0].partition(".")  # nanoseconds do not fit a float
            stamp_ns = int(seconds) * 10**9 + int((fraction + "0" * 9)[:9])
            x, y, z, *q = (float(word) for word in words[1:])
            norm = math.hypot(*q)
            rows.append((stamp_ns, ((x, y, z), tuple(c / norm for c in q))))
    return rows


def write_tum(path, rows):
    with open(path, "w", encoding="ascii") as file:
        for stamp_ns, (position, quaternion) in rows:
            numbers = " ".join(f"{number:.9g}" for number in (*position, *quaternion))
            file.write(f"{stamp_ns // 10**9}.{stamp_ns % 10**9:09d} {numbers}\n")
