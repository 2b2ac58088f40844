#!/usr/bin/env python3
"""Light from Lambent in Python: one picture and one query of irradiance, by ctypes alone.

usage: room.py OUT.png [LIBRARY]     LIBRARY: liblambent.so of the installed package, where the loader does not find it

A room with a block and a lamp. The library draws the surfaces itself; the picture is put together here.
"""

import ctypes as c
import math
import struct
import sys
import zlib

WIDTH, HEIGHT, FRAMES = 160, 120, 40


# OpenGL, by EGL without a display ------------------------------------------------------------------------------------

egl = c.CDLL("libEGL.so.1")
for name in ("eglGetPlatformDisplay", "eglCreateContext", "eglGetProcAddress"):
    getattr(egl, name).restype = c.c_void_p


def make_context():
    surfaceless, opengl = 0x31DD, 0x30A2
    display = c.c_void_p(egl.eglGetPlatformDisplay(surfaceless, None, None))
    if not egl.eglInitialize(display, None, None):
        sys.exit("room.py: EGL has no display")
    egl.eglBindAPI(opengl)
    attributes = (c.c_int * 5)(0x3098, 4, 0x30FB, 5, 0x3038)  # version 4.5
    context = c.c_void_p(egl.eglCreateContext(display, None, None, attributes))
    if not egl.eglMakeCurrent(display, None, None, context):
        sys.exit("room.py: EGL has no OpenGL 4.5")


def read_texture(name):
    """RGB of all texels, rows from the bottom."""
    if name == 0:
        return [(0.0, 0.0, 0.0)] * (WIDTH * HEIGHT)
    get = c.CFUNCTYPE(None, c.c_uint, c.c_int, c.c_uint, c.c_uint, c.c_int, c.c_void_p)(
        egl.eglGetProcAddress(b"glGetTextureImage"))
    texels = (c.c_float * (3 * WIDTH * HEIGHT))()
    get(name, 0, 0x1907, 0x1406, c.sizeof(texels), texels)  # GL_RGB, GL_FLOAT
    return [texels[i:i + 3] for i in range(0, len(texels), 3)]


# What of lambent.h is needed here: structs as they stand there ---------------------------------------------------------

class Struct(c.Structure):
    """A descriptor, with its defaults."""
    kind = None

    def __init__(self, **values):
        super().__init__()
        check(lib.lambent_defaults(self.kind, c.byref(self), c.c_size_t(c.sizeof(self))))
        for name, value in values.items():
            field = getattr(type(self), name)
            setattr(self, name, dict(self._fields_)[name](*value) if isinstance(value, (tuple, list)) else value)


vec3, mat4 = c.c_float * 3, c.c_float * 16
floats, uints = c.POINTER(c.c_float), c.POINTER(c.c_uint32)


class Material(Struct):
    kind = 2
    _fields_ = [("size", c.c_size_t), ("base_color", vec3), ("base_texture", c.c_uint64), ("emission", vec3),
                ("emission_texture", c.c_uint64), ("double_sided", c.c_int), ("alpha_mode", c.c_int32),
                ("alpha", c.c_float), ("alpha_cutoff", c.c_float), ("base_uv_set", c.c_int32),
                ("emission_uv_set", c.c_int32), ("base_uv", c.c_float * 6), ("emission_uv", c.c_float * 6),
                ("back_hidden", c.c_int)]


class Mesh(Struct):
    kind = 3
    _fields_ = [("size", c.c_size_t), ("vertex_count", c.c_uint32), ("triangle_count", c.c_uint32),
                ("positions", floats), ("normals", floats), ("uvs", floats), ("uvs1", floats), ("colors", floats),
                ("indices", uints), ("submeshes", c.c_void_p), ("submesh_count", c.c_uint32), ("material", c.c_uint64),
                ("name", c.c_char_p)]


class Light(Struct):
    kind = 4
    _fields_ = [("size", c.c_size_t), ("type", c.c_int), ("position", vec3), ("direction", vec3), ("intensity", vec3),
                ("range", c.c_float), ("inner_cone_angle", c.c_float), ("outer_cone_angle", c.c_float),
                ("angular_radius", c.c_float)]


class View(Struct):
    kind = 6
    _fields_ = [("size", c.c_size_t), ("width", c.c_int), ("height", c.c_int)]


class Frame(Struct):
    kind = 7
    _fields_ = [("size", c.c_size_t), ("time", c.c_double), ("world_from_view", mat4), ("fov_y", c.c_float),
                ("ortho_half_height", c.c_float), ("near_plane", c.c_float), ("far_plane", c.c_float),
                ("depth", c.c_uint32), ("normal", c.c_uint32), ("emission", c.c_uint32), ("depth_type", c.c_int),
                ("depth_minus_one", c.c_int), ("normal_type", c.c_int), ("normal_space", c.c_int),
                ("origin_top", c.c_int), ("x", c.c_int), ("y", c.c_int), ("indirect_out", c.c_uint32),
                ("direct_out", c.c_uint32)]


class Output(Struct):
    kind = 8
    _fields_ = [("size", c.c_size_t), ("indirect", c.c_uint32), ("direct", c.c_uint32), ("depth", c.c_uint32),
                ("normal", c.c_uint32), ("albedo", c.c_uint32), ("emission", c.c_uint32), ("converged", c.c_int),
                ("milliseconds", c.c_double)]


lib = c.CDLL(sys.argv[2] if len(sys.argv) > 2 else "liblambent.so.0")
lib.lambent_message.restype = c.c_char_p
lib.lambent_version_text.restype = c.c_char_p
device = c.c_void_p()


def check(status):
    if status != 0:
        sys.exit("room.py: " + lib.lambent_message(device).decode())


def made(create, *arguments):
    number = c.c_uint64()
    check(create(device, *arguments, c.byref(number)))
    return number


def box(scene, low, high, color):
    """A box as an instance of its own; seen from inside where low is above high."""
    corners = [[(low, high)[i >> a & 1][a] for a in range(3)] for i in range(8)]
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    positions = [x for quad in quads for corner in quad for x in corners[corner]]
    indices = [4 * q + k for q in range(6) for k in (0, 1, 2, 0, 2, 3)]
    material = made(lib.lambent_material_create, scene, c.byref(Material(base_color=color)))
    mesh = Mesh(vertex_count=24, triangle_count=12, material=material.value)
    mesh.positions = c.cast((c.c_float * 72)(*positions), floats)
    mesh.indices = c.cast((c.c_uint32 * 36)(*indices), uints)
    made(lib.lambent_instance_create, scene, made(lib.lambent_mesh_create, scene, c.byref(mesh)),
         mat4(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1))


def write_png(file, pixels):
    """Rows from the bottom, linear."""
    def encoded(v):
        v = min(max(v, 0.0), 1.0)
        return round(255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055))

    rows = b"".join(b"\0" + bytes(encoded(v) for p in pixels[WIDTH * y:WIDTH * (y + 1)] for v in p)
                    for y in reversed(range(HEIGHT)))
    with open(file, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n")
        for kind, data in ((b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)),
                           (b"IDAT", zlib.compress(rows)), (b"IEND", b"")):
            out.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))


def main():
    make_context()
    check(lib.lambent_create(None, c.byref(device)))
    scene = made(lib.lambent_scene_create)
    box(scene, (2, 2, 2), (-2, 0, -2), (0.7, 0.7, 0.7))
    box(scene, (-1, 0, -1), (-0.2, 1.1, 0), (0.7, 0.2, 0.1))
    made(lib.lambent_light_create, scene, c.byref(Light(position=(0.9, 1.6, 0.2), intensity=(3, 3, 3))))
    view = made(lib.lambent_view_create, scene, c.byref(View(width=WIDTH, height=HEIGHT)))
    eye = (0, 1, 1.9)
    frame, output = Frame(fov_y=1.1), Output()
    for i in range(3):
        frame.world_from_view[12 + i] = eye[i]
    for _ in range(FRAMES):
        check(lib.lambent_render(device, view, c.byref(frame), c.byref(output)))
    images = [read_texture(n) for n in (output.emission, output.albedo, output.indirect, output.direct)]
    write_png(sys.argv[1], [[e + a / math.pi * (i + d) for e, a, i, d in zip(*texels)] for texels in zip(*images)])

    indirect, direct = vec3(), vec3()
    check(lib.lambent_irradiance(device, view, vec3(0.5, 0.001, 0.5), vec3(0, 1, 0), c.c_size_t(1), indirect, direct))
    print(f"{sys.argv[1]}: Lambent {lib.lambent_version_text().decode()}, {FRAMES} frames, the last in "
          f"{output.milliseconds:.0f} ms; irradiance on the floor: indirect {indirect[1]:.3f}, direct {direct[1]:.3f} W/m2")
    lib.lambent_destroy(device)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__.strip())
    main()
