// Over the view of virtual lights: the one at the crosshair, with all that the sampler knows of it.
#include "game/hud.h"
#include "shaders/shared/paraboloid.h"

#include <imgui/imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lambent {

namespace {

constexpr ImU32 kChosen = IM_COL32(255, 255, 255, 255), kMailbox = IM_COL32(255, 220, 60, 255),
                kCell = IM_COL32(80, 230, 230, 160), kPath = IM_COL32(255, 140, 60, 200),
                kToLight = IM_COL32(255, 255, 200, 110);
constexpr int kPaths = 12;   // of those that a light has
constexpr int kMapSide = 28; // texels shown of its map

/// Draws in world space.
class WorldPen {
 public:
  WorldPen(const CameraView& camera, ImVec2 size)
      : clipFromWorld_(clipFromView(camera) * glm::inverse(camera.worldFromView)), size_(size),
        list_(ImGui::GetBackgroundDrawList()) {}

  std::optional<ImVec2> at(const vec3& p) const {
    const vec4 clip = clipFromWorld_ * vec4(p, 1);
    return clip.w > kBehind ? std::optional(onScreen(clip)) : std::nullopt;
  }
  /// What lies behind the eye is cut off.
  void line(const vec3& from, const vec3& to, ImU32 color, float width) const {
    vec4 a = clipFromWorld_ * vec4(from, 1), b = clipFromWorld_ * vec4(to, 1);
    if (a.w <= kBehind && b.w <= kBehind) return;
    const auto cut = [](const vec4& in, const vec4& out) {
      return glm::mix(in, out, (in.w - kBehind) / (in.w - out.w));
    };
    if (a.w <= kBehind) a = cut(b, a);
    if (b.w <= kBehind) b = cut(a, b);
    list_->AddLine(onScreen(a), onScreen(b), color, width);
  }
  void dot(const vec3& p, ImU32 color, float radius) const {
    if (const auto place = at(p)) list_->AddCircleFilled(*place, radius, color, 8);
  }

 private:
  static constexpr float kBehind = 1e-4f;
  ImVec2 onScreen(const vec4& clip) const {
    return {(0.5f + 0.5f * clip.x / clip.w) * size_.x, (0.5f - 0.5f * clip.y / clip.w) * size_.y};
  }
  const mat4 clipFromWorld_;
  const ImVec2 size_;
  ImDrawList* list_;
};

/// Slot of the light that is nearest to the crosshair and that the eye sees; kNone: no light is near it.
uint32_t atCrosshair(const VplSet& set, const RayQuery& rays, const CameraView& camera, const WorldPen& pen,
                     ImVec2 middle, float reach) {
  std::vector<std::pair<float, uint32_t>> near;
  for (uint32_t slot = 0; slot < set.slots.size(); ++slot) {
    if (!set.slots[slot].alive) continue;
    const auto place = pen.at(set.slots[slot].position);
    const float distance = place ? std::hypot(place->x - middle.x, place->y - middle.y) : kInfinity;
    if (distance < reach) near.emplace_back(distance, slot);
  }
  std::ranges::sort(near);
  for (const auto& [distance, slot] : near) {
    const Vpl& v = set.slots[slot];
    if (!rays.occluded(segment(camera.position(), offsetPoint(v.position, v.geometricNormal, rays.rayEpsilon()))))
      return slot;
  }
  return kNone;
}

void drawPaths(const KeptPaths& kept, const Vpl& vpl, const WorldPen& pen, float scale) {
  if (kept.id != vpl.id || kept.vertices.empty()) return;
  for (int path = 0; path < std::min(kept.paths, kPaths); ++path) {
    vec3 from = vpl.position;
    for (int depth = 0; depth < kept.lengths[size_t(path)]; ++depth) {
      const KeptVertex& v = kept.vertices[size_t(depth) * size_t(kept.paths) + size_t(path)];
      if (depth > 0 || kept.overCell) pen.line(from, v.at.position, kPath, 1.5f * scale);
      if (v.light.reach > 0 && v.light.passes > 0)
        pen.line(v.at.position, v.at.position + std::min(v.light.reach, 1e3f) * v.light.direction, kToLight, scale);
      from = v.at.position;
    }
  }
}

/// By rays, as the light sees: near dark, far bright.
void drawMap(const Vpl& vpl, const RayQuery& rays, float most, ImVec2 corner, float texel) {
  vec3 tangent, bitangent;
  basisAround(vpl.geometricNormal, tangent, bitangent);
  const vec3 origin = offsetPoint(vpl.position, vpl.geometricNormal, rays.rayEpsilon());
  ImDrawList* list = ImGui::GetBackgroundDrawList();
  for (int y = 0; y < kMapSide; ++y)
    for (int x = 0; x < kMapSide; ++x) {
      const vec3 d = directionFromParaboloid((vec2(x, y) + 0.5f) / float(kMapSide));
      if (d.z < 0) continue;
      const SurfaceHit hit = rays.closest({origin, d.x * tangent + d.y * bitangent + d.z * vpl.geometricNormal});
      const int grey = hit.valid() ? int(255 * std::sqrt(std::min(hit.t / most, 1.0f))) : 255;
      const ImVec2 at{corner.x + texel * float(x), corner.y + texel * float(kMapSide - 1 - y)};
      list->AddRectFilled(at, {at.x + texel, at.y + texel}, IM_COL32(grey, grey, hit.valid() ? grey : 160, 255));
    }
}

} // namespace

void drawVplAtCrosshair(const Viewer& gi, const CameraView& camera, float scale) {
  const VplSet& set = gi.vpls();
  const RayQuery& rays = gi.rays();
  const ImVec2 size = ImGui::GetIO().DisplaySize, middle{0.5f * size.x, 0.5f * size.y};
  const WorldPen pen(camera, size);
  const uint32_t slot = atCrosshair(set, rays, camera, pen, middle, 0.2f * size.y);
  if (slot == kNone) return;
  const Vpl& vpl = set.slots[slot];
  if (slot < set.cells.size())
    for (const CellPoint& p : set.cells[slot].points) pen.dot(p.position, kCell, 2 * scale);
  if (slot < set.lightPaths.size()) drawPaths(set.lightPaths[slot], vpl, pen, scale);
  pen.line(vpl.position, vpl.mailbox, kMailbox, 1.5f * scale);
  pen.dot(vpl.mailbox, kMailbox, 4 * scale);
  if (const auto at = pen.at(vpl.position))
    ImGui::GetBackgroundDrawList()->AddCircle(*at, 9 * scale, kChosen, 24, 2 * scale);

  const float texel = std::max(1.0f, std::floor(0.3f * size.y / float(kMapSide))), side = texel * float(kMapSide);
  const float legend = 44 * scale; // stays free for it
  const ImVec2 corner{size.x - side - 8, size.y - side - legend};
  drawMap(vpl, rays, glm::distance(camera.position(), vpl.position) * 2, corner, texel);
  char text[200];
  std::snprintf(text, sizeof text,
                "light %u: %u frames old, %.3g W/sr over %.3g m2\nyellow: its mailbox  blue: its cell\n"
                "orange: its paths  right: its map",
                slot, set.frame - vpl.bornFrame, double(vpl.intensity()), double(vpl.area));
  const ImVec2 extent = ImGui::CalcTextSize(text);
  const ImVec2 at{std::max(corner.x - extent.x - 12, 8.0f), size.y - extent.y - legend - 4};
  ImDrawList* list = ImGui::GetBackgroundDrawList();
  list->AddRectFilled({at.x - 4, at.y - 4}, {at.x + extent.x + 4, at.y + extent.y + 4}, IM_COL32(0, 0, 0, 160));
  list->AddText(at, IM_COL32(255, 255, 255, 255), text);
}

} // namespace lambent
