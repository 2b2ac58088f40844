// Makes the files of this folder valid C++ and GLSL: each struct and mapping that both sides use is written once.
#pragma once
#ifdef __cplusplus
#include "engine/core/math.h"
#define SHARED_INLINE inline
#define SHARED_OUT(T) T&
namespace lambent {
using glm::abs;
using glm::acos;
using glm::atan;
using glm::clamp;
using glm::cross;
using glm::dot;
using glm::exp;
using glm::floor;
using glm::inversesqrt;
using glm::ivec2;
using glm::length;
using glm::max;
using glm::min;
using glm::mix;
using glm::normalize;
using glm::pow;
using glm::sqrt;
using glm::uint;
using glm::uvec2;
using glm::uvec4;
} // namespace lambent
#define SHARED_BEGIN namespace lambent {
#define SHARED_END }
#else
#define SHARED_INLINE
#define SHARED_OUT(T) out T
#define SHARED_BEGIN
#define SHARED_END
#endif
