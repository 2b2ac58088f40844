#include "game/rules/solids.h"

#include <algorithm>

namespace lambent {

Solids::Solids(const Scene& scene) : scene_(scene), rays_(scene.assets) { update(); }

void Solids::update() {
  view_ = extractor_.extract(scene_, {}, 0);
  if (hidden_) {
    shown_.assign(view_.instances.begin(), view_.instances.end());
    std::erase_if(shown_, [&](const InstanceView& i) { return i.id == *hidden_; });
    view_.instances = shown_;
  }
  rays_.update(view_);
}

void Solids::hide(std::optional<uint32_t> instance) {
  if (instance == hidden_) return;
  hidden_ = instance;
  update();
  rays_.update(view_, true); // others have taken its place in the list
}

std::optional<mat4> motionOf(const SceneView& view, uint32_t instance) {
  const auto found = std::ranges::find(view.instances, instance, &InstanceView::id);
  if (found == view.instances.end() || !found->moved || found->deformed) return {};
  if (!(std::abs(glm::determinant(mat3(found->worldFromObjectBefore))) > 0)) return {};
  return found->worldFromObject * glm::inverse(found->worldFromObjectBefore);
}

} // namespace lambent
