"""Draws a scene in a program with wgpu-py beside a cube of the program's own triangles.

    python draw.py FOLDER/scene.py WIDTH HEIGHT X Y Z SIDE PARAMETER VALUE

FOLDER takes the pictures as bytes, four for each pixel: the scene, both, the cube, the scene with the parameter set, and the same after the program has moved the object.
Prints how long the first picture took, in seconds.
"""

import importlib.util
import itertools
import math
import pathlib
import sys
import time

import numpy
import wgpu

CUBE = """
@group(0) @binding(0) var<uniform> to_clip: mat4x4f;
@vertex fn corner(@location(0) at: vec3f) -> @builtin(position) vec4f { return to_clip * vec4f(at, 1.0); }
@fragment fn magenta() -> @location(0) vec4f { return vec4f(1.0, 0.0, 1.0, 1.0); }
"""
COLOR, DEPTH = "rgba8unorm", "depth32float"


def main(path, width, height, x, y, z, side, parameter, value):
    path = pathlib.Path(path)
    size = width, height = int(width), int(height)
    spec = importlib.util.spec_from_file_location("scene", path)
    scene = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scene)
    device = wgpu.gpu.request_adapter_sync().request_device_sync()
    began = time.perf_counter()
    field = scene.Field(device, COLOR, DEPTH)
    field.playing = False
    usage = wgpu.TextureUsage
    color = device.create_texture(size=(width, height, 1), format=COLOR, usage=usage.RENDER_ATTACHMENT | usage.COPY_SRC)
    depth = device.create_texture(size=(width, height, 1), format=DEPTH, usage=usage.RENDER_ATTACHMENT)

    # Two triangles for each of six sides.
    corners = []
    for axis, end in itertools.product(range(3), (-0.5, 0.5)):
        for u, v in ((0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)):
            corners.append(numpy.roll([end, u - 0.5, v - 0.5], axis) * float(side) + [float(x), float(y), float(z)])
    vertices = device.create_buffer_with_data(data=numpy.array(corners, numpy.float32).tobytes(), usage=wgpu.BufferUsage.VERTEX)
    matrix = device.create_buffer(size=64, usage=wgpu.BufferUsage.UNIFORM | wgpu.BufferUsage.COPY_DST)
    module = device.create_shader_module(code=CUBE)
    attributes = [{"format": "float32x3", "offset": 0, "shader_location": 0}]
    pipeline = device.create_render_pipeline(
        layout="auto",
        vertex={"module": module, "entry_point": "corner", "buffers": [{"array_stride": 12, "attributes": attributes}]},
        primitive={"topology": "triangle-list"},
        depth_stencil={"format": DEPTH, "depth_write_enabled": True, "depth_compare": "less"},
        fragment={"module": module, "entry_point": "magenta", "targets": [{"format": COLOR}]},
    )
    binding = [{"binding": 0, "resource": {"buffer": matrix}}]
    group = device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=binding)

    def draw(picture, shown, cubed):
        view, projection = field.camera(width / height)
        device.queue.write_buffer(matrix, 0, (projection @ view).T.astype(numpy.float32).tobytes())
        encoder = device.create_command_encoder()
        rendering = encoder.begin_render_pass(
            color_attachments=[{"view": color.create_view(), "load_op": "clear", "store_op": "store"}],
            depth_stencil_attachment={"view": depth.create_view(), "depth_load_op": "clear", "depth_store_op": "store", "depth_clear_value": 1.0},
        )
        if shown:
            field.draw(rendering, view, projection, size)
        if cubed:
            rendering.set_pipeline(pipeline)
            rendering.set_bind_group(0, group)
            rendering.set_vertex_buffer(0, vertices)
            rendering.draw(36)
        rendering.end()
        device.queue.submit([encoder.finish()])
        pixels = device.queue.read_texture({"texture": color}, {"bytes_per_row": 4 * width, "rows_per_image": height}, (width, height, 1))
        path.with_name(f"{picture}.rgba").write_bytes(pixels)

    draw("plain", True, False)
    print(time.perf_counter() - began)
    draw("with", True, True)
    draw("cube", False, True)
    field.parameters[parameter] = float(value)
    draw("moved", True, False)
    sine, cosine = math.sin(0.7), math.cos(0.7)
    field.world = numpy.array([[2 * cosine, 0, 2 * sine, 1], [0, 2, 0, 2], [-2 * sine, 0, 2 * cosine, 3], [0, 0, 0, 1]])
    draw("turned", True, False)


main(*sys.argv[1:])
