// Who decides between the CPU's makers and the GPU's where a setting says auto.
#pragma once

namespace lambent {

/// What auto means for ShadowMaker, AreaTracer and CubeMaker: the CPU where OpenGL is drawn by it, else the GPU | as
/// measured once: the GPU where it is twice as fast, else the CPU, which may come out otherwise the next time.
enum class Makers : int { ByRule, Measured };

} // namespace lambent
