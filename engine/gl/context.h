// What Lambent asks of the OpenGL context that it draws in. The host makes it, with whatever window system or none, and
// has it current on the thread that calls:
//
//   OpenGL 4.5 or newer, core profile; uniform blocks of 64 KiB; array textures of 2048 layers.
//
// No loader function is asked for: epoxy, through which all calls go, finds each by itself at its first use, by
// glXGetProcAddress where the current context is GLX's and by eglGetProcAddress where it is EGL's, so windows of GLFW,
// SDL, Qt, X11 and Wayland do, and contexts without a surface. (Not OSMesa, which epoxy does not know.)
//
// The context may be the host's own, whose state every call of GiFrame leaves as found (StateGuard), or a second one
// that shares objects with it, on a thread of its own; textures by name (GiFrame::indirectIrradiance) then need the
// host's fence.
#pragma once

#include <string>

namespace lambent::gl {

/// Throws RunError, in one line, where no context is current on this thread or it is not as above.
void requireContext();

/// Whether GL_RENDERER names a driver that draws on the CPU.
bool drawnByCpu(const std::string& renderer);
/// Whether the current context is drawn by one.
bool drawnByCpu();

} // namespace lambent::gl
