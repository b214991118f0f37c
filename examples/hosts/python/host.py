"""Draws a module that `surefoot compile` wrote into a PNG file. Nothing else of Surefoot is needed.

    python host.py ../scene.wgsl picture.png --eye 4 3 6 --target 0 0 0 --fov 40 --set melt 0.5
"""

import argparse
import itertools
import keyword
import math
import pathlib
import re
import struct
import types
import zlib

import wgpu

HERE = pathlib.Path(__file__).parent


def live_values(wgsl):
    """The module's head has a table of its live values: offset in bytes, type, name, value at the start, range.

    What has no offset stands in no place of the block: other values are computed from it.
    """
    lines = wgsl.splitlines()
    top = next((i for i, line in enumerate(lines) if re.fullmatch("// +offset +type +name +default +range", line)), None)
    if top is None:
        return
    name, start, end = (lines[top].index(word) for word in ("name", "default", "range"))
    for row in itertools.takewhile(lambda line: line.startswith("//  "), lines[top + 1 :]):
        offset = row[2:].split()[0]
        yield None if offset == "-" else int(offset), row[name:start].strip(), [float(value) for value in row[start:end].split(", ")]


FUNCTIONS = {
    **{name: getattr(math, name) for name in ("sin", "cos", "tanh", "floor", "ceil", "trunc")},
    **{"min": min, "max": max, "abs": abs, "round": round, "length2": math.hypot, "length3": math.hypot, "length4": math.hypot},
    "square": lambda a: a * a,
    "div": lambda a, b: a / b if b else 0.0,
    "sqrt": lambda a: math.sqrt(max(a, 0.0)),
    "exp": lambda a: math.exp(min(a, 88.0)),
    "log": lambda a: math.log(max(a, 1e-37)),
    "pow": lambda a, b: min(max(a, 0.0) ** b, 1e30) if a > 0 else float(b == 0),
    **{name: (lambda f: lambda a: f(min(max(a, -1.0), 1.0)))(getattr(math, name)) for name in ("asin", "acos")},
    **{name: getattr(math, name) for name in ("atan", "atan2")},
    "sign": lambda a: (a > 0) - (a < 0),
    "select": lambda c, a, b: a if c else b,
    "turn_u": lambda u, v, t: u * math.cos(t) - v * math.sin(t),
    "turn_v": lambda u, v, t: u * math.sin(t) + v * math.cos(t),
    "both": lambda a, b: a and b,
    "either": lambda a, b: a or b,
    "no": lambda a: not a,
    **{f"vec{n}": (lambda *numbers: numbers) for n in (2, 3, 4)},
}


def computed(wgsl, live):
    """Below the table stand formulas, `swing = 0.5 * sin(time)`, of what is computed from parameters and time once a frame."""

    def named(values):
        return values[0] if len(values) == 1 else types.SimpleNamespace(**dict(zip("xyzw", values)))

    def safe(text):
        """A word of Python's own is no name in it."""
        return re.sub(rf"\b({'|'.join(keyword.kwlist)})\b", r"\1_", text)

    known = {safe(name): named(values) for name, values in live.items()}
    found = {}
    for name, formula in re.findall(r"^//   (\w+) = (.+)$", wgsl, re.MULTILINE):
        value = known[safe(name)] = eval(safe(formula), {"__builtins__": {}, **FUNCTIONS}, known)
        found[name] = value if isinstance(value, tuple) else (value,)
    return found


def block(wgsl, changed):
    """The bytes of the module's uniform block."""
    live = list(live_values(wgsl))
    unknown = set(changed) - {name for _, name, _ in live}
    if unknown:
        raise SystemExit(f"the module has no live value {', '.join(sorted(unknown))}")
    values_of = {name: changed.get(name, start) for _, name, start in live}
    values_of.update(computed(wgsl, values_of))
    inside = [(offset, values_of[name]) for offset, name, _ in live if offset is not None]
    data = bytearray(-(-max((offset + 4 * len(values) for offset, values in inside), default=0) // 16) * 16)
    for offset, values in inside:
        struct.pack_into(f"<{len(values)}f", data, offset, *values)
    return data


def camera(eye, target, fov, width, height):
    """The bytes of `View` in picture.wgsl."""
    back = [e - t for e, t in zip(eye, target)]
    distance = math.hypot(*back)
    x, y, z = (b / distance for b in back)
    level = math.hypot(x, z)
    half = math.tan(math.radians(fov) / 2)
    right = (z / level, 0, -x / level)
    up = (-x * y / level, level, -z * y / level)
    scaled = [[half * c for c in axis] for axis in (right, up)]
    rows = (*eye, 2 * half / height), (*scaled[0], width), (*scaled[1], height), (-x, -y, -z, 100)
    return struct.pack("<16f", *(value for row in rows for value in row))


def draw(wgsl, groups, entry_point, width, height):
    """The picture's pixels, four bytes each, rows from the top. `groups`: for each bind group the kind and the bytes of its buffers, by binding."""
    device = wgpu.gpu.request_adapter_sync(power_preference="high-performance").request_device_sync()
    module = device.create_shader_module(code=wgsl)
    texture = device.create_texture(
        size=(width, height, 1),
        format="rgba8unorm",
        usage=wgpu.TextureUsage.RENDER_ATTACHMENT | wgpu.TextureUsage.COPY_SRC,
    )
    pipeline = device.create_render_pipeline(
        layout="auto",
        vertex={"module": module, "entry_point": "corner"},
        primitive={"topology": "triangle-list"},
        fragment={"module": module, "entry_point": entry_point, "targets": [{"format": "rgba8unorm"}]},
    )
    encoder = device.create_command_encoder()
    target = {"view": texture.create_view(), "load_op": "clear", "store_op": "store"}
    rendering = encoder.begin_render_pass(color_attachments=[target])
    rendering.set_pipeline(pipeline)
    for group, buffers in enumerate(groups):
        # A module without live values has no uniform block.
        entries = [
            {"binding": binding, "resource": {"buffer": device.create_buffer_with_data(data=data, usage=usage)}}
            for binding, (usage, data) in enumerate(buffers)
            if data
        ]
        if entries:
            layout = pipeline.get_bind_group_layout(group)
            rendering.set_bind_group(group, device.create_bind_group(layout=layout, entries=entries))
    rendering.draw(3)
    rendering.end()
    device.queue.submit([encoder.finish()])
    return device.queue.read_texture(
        {"texture": texture},
        {"bytes_per_row": 4 * width, "rows_per_image": height},
        (width, height, 1),
    )


def png(pixels, width, height):
    """A PNG file (RFC 2083)."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + pixels[4 * width * y : 4 * width * (y + 1)] for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def main():
    parser = argparse.ArgumentParser(description="Draws a module that `surefoot compile` wrote into a PNG file.")
    parser.add_argument("module", type=pathlib.Path)
    parser.add_argument("picture", type=pathlib.Path)
    parser.add_argument("--eye", nargs=3, type=float, default=(4, 3, 6))
    parser.add_argument("--target", nargs=3, type=float, default=(0, 0, 0))
    parser.add_argument("--fov", type=float, default=40, help="degrees from the bottom to the top")
    parser.add_argument("--size", nargs=2, type=int, default=(960, 540))
    parser.add_argument("--view", choices=["picture", "normals"], default="picture")
    parser.add_argument("--set", nargs="+", action="append", default=[], metavar=("NAME", "NUMBER"))
    options = parser.parse_args()
    scene = options.module.read_text()
    changed = {name: [float(value) for value in values] for name, *values in options.set}
    wgsl = scene + (HERE.parent / "picture.wgsl").read_text()
    uniform, storage = wgpu.BufferUsage.UNIFORM, wgpu.BufferUsage.STORAGE
    # What `--tables buffers` wrote beside the module.
    tables = [options.module.with_suffix(end) for end in (".table.bin", ".lists.bin") if "var<storage, read>" in scene]
    groups = (
        [(uniform, block(scene, changed)), *((storage, table.read_bytes()) for table in tables)],
        [(uniform, camera(options.eye, options.target, options.fov, *options.size))],
    )
    pixels = bytes(draw(wgsl, groups, options.view, *options.size))
    options.picture.write_bytes(png(pixels, *options.size))


main()
