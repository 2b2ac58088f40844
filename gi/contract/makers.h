// Who decides between the CPU's makers and the GPU's where a setting says auto.
#pragma once

namespace lambent {

/// The CPU's where OpenGL is drawn by it, else the GPU's | whoever is faster, as measured once, which may come out
/// otherwise the next time.
enum class Makers : int { ByRule, Measured };

} // namespace lambent
