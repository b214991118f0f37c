#!/usr/bin/env python3
"""Makes the images of the examples: stones in mortar, and how high they stand. They repeat without a seam.

    python3 examples/images/make.py
"""

import math
import random
import struct
import zlib
from pathlib import Path

SIDE = 256
CELLS = 6


def noise(seed, cells):
    """Smooth noise from -1 to 1 over the unit square, repeated without a seam."""
    chance = random.Random(seed)
    grid = [[chance.uniform(-1, 1) for _ in range(cells)] for _ in range(cells)]

    def at(u, v):
        x, y = u * cells, v * cells
        i, j = math.floor(x), math.floor(y)
        s, t = (f * f * (3 - 2 * f) for f in (x - i, y - j))
        corner = lambda a, b: grid[(j + b) % cells][(i + a) % cells]
        top = corner(0, 0) * (1 - s) + corner(1, 0) * s
        return top * (1 - t) + (corner(0, 1) * (1 - s) + corner(1, 1) * s) * t

    return at


def octaves(seed, cells, count):
    parts = [noise(seed + i, cells << i) for i in range(count)]
    return lambda u, v: sum(part(u, v) / 2**i for i, part in enumerate(parts))


def stones():
    """Each pixel's colour and height."""
    chance = random.Random(11)
    sites = [[(chance.uniform(0.15, 0.85), chance.uniform(0.15, 0.85), chance.random()) for _ in range(CELLS)] for _ in range(CELLS)]
    grain, warp_u, warp_v = octaves(1, 16, 4), octaves(21, 4, 3), octaves(31, 4, 3)
    for row in range(SIDE):
        for column in range(SIDE):
            u, v = (column + 0.5) / SIDE, (row + 0.5) / SIDE
            x, y = CELLS * u + 0.25 * warp_u(u, v), CELLS * v + 0.25 * warp_v(u, v)
            near = []
            for j in range(math.floor(y) - 1, math.floor(y) + 2):
                for i in range(math.floor(x) - 1, math.floor(x) + 2):
                    a, b, tint = sites[j % CELLS][i % CELLS]
                    near.append((math.hypot(i + a - x, j + b - y), tint))
            near.sort()
            edge = near[1][0] - near[0][0]
            body = min(max((edge - 0.05) / 0.25, 0), 1)
            body = body * body * (3 - 2 * body)
            rough = grain(u, v)
            light = (0.30 + 0.55 * near[0][1] * 0.6 + 0.10 * rough) * body + (0.16 + 0.05 * rough) * (1 - body)
            warm = near[0][1] - 0.5
            color = (light * (1.08 + 0.15 * warm), light, light * (0.88 - 0.15 * warm))
            yield color, 0.1 + 0.75 * body + 0.08 * rough * (0.3 + 0.7 * body)


def write(path, channels, rows):
    """A PNG of one channel or three, eight bits each."""
    raw = b"".join(b"\1" + bytes((row[i] - (row[i - channels] if i >= channels else 0)) & 255 for i in range(len(row))) for row in rows)
    header = struct.pack(">IIBBBBB", SIDE, SIDE, 8, 0 if channels == 1 else 2, 0, 0, 0)
    chunk = lambda name, data: struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def main():
    folder = Path(__file__).parent
    byte = lambda c: min(max(round(255 * c), 0), 255)
    pixels = list(stones())
    rows = [pixels[i : i + SIDE] for i in range(0, len(pixels), SIDE)]
    write(folder / "stone.png", 3, [bytes(byte(c) for color, _ in row for c in color) for row in rows])
    write(folder / "stone_height.png", 1, [bytes(byte(height) for _, height in row) for row in rows])


main()
