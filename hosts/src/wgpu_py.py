%%HEAD%%
import json
import math
import struct
import time

import numpy
import wgpu

SCENE = json.loads(r'''%%SCENE%%''')

# The bytes of the module's uniform block at the start.
START = bytes.fromhex("%%START%%")

MODULE = r'''%%MODULE%%'''

# The field's own triangle over the picture. Targets that encode sRGB are given light's own numbers.
ENTRIES = """
struct sf_HostVertex { @builtin(position) position: vec4f, @location(0) at: vec2f }
struct sf_HostFragment { @location(0) color: vec4f, @builtin(frag_depth) depth: f32 }
@vertex
fn sf_host_vertex(@builtin(vertex_index) index: u32) -> sf_HostVertex {
  let corner = vec2f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0);
  return sf_HostVertex(vec4f(corner, 0.0, 1.0), vec2f(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y));
}
@fragment
fn sf_host_fragment(in: sf_HostVertex) -> sf_HostFragment {
  let picture = PICTURE(in.at * sf_uniforms.view_size);
  SKY
  let c = clamp(picture.color.rgb, vec3f(), vec3f(1.0));
  return sf_HostFragment(vec4f(COLOR, 1.0), picture.depth);
}
"""
LINEAR = "select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045))"
NO_SKY = "if (picture.depth == select(0.0, 1.0, sf_uniforms.view_far > sf_uniforms.view_near)) { discard; }"


class Field:
    """The scene as one draw of a render pass: a triangle over the picture whose shader traces the field and writes its depth."""

    def __init__(self, device, color_format, depth_format=None, *, depth_compare="less-equal", sample_count=1, sky=True):
        """The formats are those of the pass. `sky`: whether it draws the scene's sky where nothing stands. The sky is as far as depth goes."""
        self.device = device
        code = ENTRIES.replace("PICTURE", SCENE["picture"]).replace("SKY", "" if sky else NO_SKY)
        code = code.replace("COLOR", LINEAR if color_format.endswith("-srgb") else "c")
        module = device.create_shader_module(code=MODULE + code)
        depth = {"format": depth_format, "depth_write_enabled": True, "depth_compare": depth_compare}
        self.pipeline = device.create_render_pipeline(
            layout="auto",
            vertex={"module": module, "entry_point": "sf_host_vertex"},
            primitive={"topology": "triangle-list"},
            depth_stencil=depth if depth_format else None,
            multisample={"count": sample_count},
            fragment={"module": module, "entry_point": "sf_host_fragment", "targets": [{"format": color_format}]},
        )
        self.bytes = bytearray(START)
        self.buffer = device.create_buffer(size=len(START), usage=wgpu.BufferUsage.UNIFORM | wgpu.BufferUsage.COPY_DST)
        binding = {"binding": 0, "resource": {"buffer": self.buffer}}
        self.group = device.create_bind_group(layout=self.pipeline.get_bind_group_layout(0), entries=[binding])
        # Where the object stands in the host's world: four rows of four numbers, which points are columns to.
        self.world = numpy.eye(4)
        # The scene's parameters by their names: one number, or two to four. Angles are in radians.
        fields = [field for field in SCENE["fields"] if field["source"] == "parameter"]
        self.parameters = {field["parameter"]: field["start"] if len(field["start"]) > 1 else field["start"][0] for field in fields}
        # The scene's time in seconds. While `playing`, it is that since the first picture.
        self.time = 0.0
        self.playing = True
        self.began = None

    def camera(self, aspect):
        """The scene's own camera for a picture that is `aspect` times as wide as high: view and projection, as `draw` takes them."""
        camera = SCENE["camera"]
        eye, target, up = (numpy.array(camera[name]) for name in ("eye", "target", "up"))
        back = (eye - target) / numpy.linalg.norm(eye - target)
        right = numpy.cross(up, back)
        right /= numpy.linalg.norm(right)
        size = numpy.linalg.norm(self.world[:3, 2])
        pose = numpy.eye(4)
        pose[:3] = numpy.column_stack([right, numpy.cross(back, right), back, eye])
        pose = self.world @ pose
        pose[:3, :3] /= size
        near, far = size * camera["near"], size * camera["far"]
        projection = numpy.zeros((4, 4))
        if camera["fov"]:
            projection[1, 1] = 1 / math.tan(camera["fov"] / 2)
            projection[2, 2:] = far / (near - far), near * far / (near - far)
            projection[3, 2] = -1
        else:
            projection[1, 1] = 2 / (size * camera["height"])
            projection[2, 2:] = 1 / (near - far), near / (near - far)
            projection[3, 3] = 1
        projection[0, 0] = projection[1, 1] / aspect
        return numpy.linalg.inv(pose), projection

    def draw(self, render_pass, view, projection, size):
        """Draws it in a pass that has begun, before or after the host's own triangles.

        `view` brings points of the world before the camera, `projection` these to clip space, whose depth begins at 0: four rows of four
        numbers each. `size`: width and height of the picture, in pixels. A field has one view for each time that its commands are submitted.
        """
        if self.playing:
            self.began = self.began or time.perf_counter()
            self.time = time.perf_counter() - self.began
        known = look(numpy.linalg.inv(self.world) @ numpy.linalg.inv(view), numpy.asarray(projection), size)
        for field in SCENE["fields"]:
            value = known[field["name"]] if field["source"] == "view" else self.time if field["source"] == "time" else self.parameters[field["parameter"]]
            values = numpy.atleast_1d(value)
            struct.pack_into(f"<{len(values)}f", self.bytes, field["offset"], *values)
        self.device.queue.write_buffer(self.buffer, 0, self.bytes)
        render_pass.set_pipeline(self.pipeline)
        render_pass.set_bind_group(0, self.group)
        render_pass.draw(3)


def look(camera, p, size):
    """What the shader is told of a view. `camera`: the camera in the space of the field. `p`: its projection."""
    parallel = bool(p[3, 3] == 1)
    if parallel != SCENE["parallel"]:
        rays, needed = ("go side by side", "an orthographic") if SCENE["parallel"] else ("come from the eye", "a perspective")
        raise ValueError(f"The rays of {SCENE['name']} {rays}: it needs {needed} projection.")
    right, up, back, eye = camera[:3].T
    # What a unit of the host is in the scene.
    unit = numpy.linalg.norm(back)
    ahead = -back / unit
    # Where rays go side by side, what is looked at says how far it is from where they begin.
    reach = max(float((SCENE["camera"]["target"] - eye) @ ahead), 1e-3)
    near = p[2, 3] / p[2, 2]
    most = p[2, 2] + 1
    far = (p[2, 3] - 1) / p[2, 2] if parallel else p[2, 3] / most if abs(most) > 1e-12 else 1e12
    x, y = (-p[0, 3], -p[1, 3]) if parallel else (p[0, 2], p[1, 2])
    width, height = size
    return {
        "view_eye": eye,
        "view_look_at": eye + reach * ahead,
        "view_up": up,
        "view_fov": 2 * math.atan(1 / p[1, 1]),
        "view_height": 2 * unit / p[1, 1],
        "view_near": near * unit,
        "view_far": far * unit,
        "view_size": (width, height),
        # A picture that is not in the middle of what the camera sees.
        "view_corner": (-0.5 * width * x, 0.5 * height * y),
    }
