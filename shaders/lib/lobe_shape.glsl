// How alike the lobes of two receivers are, for filters of glossy light.
#include "shared/ggx.h"

/// What lobes are told apart by; finishes as makeReceiver takes them. `least`: roughness below which lobes are alike.
vec4 shapeOfLobe(vec4 finish, float least) { return vec4(0.24 * log2(max(finish.x, least)), finish.yzw); }

/// Lobes of another shape hold other light: exp(-Δ²/2σ²), σ = 0.1 of metalness, F0 and weight, and of roughness around
/// 0.35: a third more or less of it.
float finishWeight(vec4 shape, vec4 other) {
  vec4 difference = other - shape;
  return exp2(-72.13475 * dot(difference, difference));
}
