# SPDX-License-Identifier: Apache-2.0
"""Two paths seen from above, in one picture: by matplotlib where it is installed, else an SVG written by hand."""


def draw(path, odometry, corrected):
    """`odometry` and `corrected`: positions (x, y, z)."""
    try:
        from matplotlib import pyplot
    except ImportError:
        return draw_svg(path, odometry, corrected)
    figure, axes = pyplot.subplots()
    for name, points in (("odometry", odometry), ("corrected", corrected)):
        axes.plot([p[0] for p in points], [p[1] for p in points], label=name)
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.legend()
    figure.savefig(path)
    return None


def draw_svg(path, odometry, corrected, size=600, margin=40):
    points = odometry + corrected
    left, top = min(p[0] for p in points), max(p[1] for p in points)
    extent = max(max(p[0] for p in points) - left, top - min(p[1] for p in points), 1e-9)
    scale = (size - 2 * margin) / extent

    def polyline(positions, colour):
        line = " ".join(f"{margin + scale * (p[0] - left):.1f},{margin + scale * (top - p[1]):.1f}" for p in positions)
        return f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>'

    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join([
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size} {size}" font-family="sans-serif" font-size="14">',
            '<rect width="100%" height="100%" fill="white"/>',
            polyline(odometry, "#d55e00"), polyline(corrected, "#0072b2"),
            f'<text x="{margin}" y="20" fill="#d55e00">odometry</text>',
            f'<text x="{margin + 90}" y="20" fill="#0072b2">corrected; {extent:.1f} m across</text>',
            "</svg>", ""]))
