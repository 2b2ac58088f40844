// Lists of lights on the GPU, for gathers.
#pragma once

#include "engine/gl/objects.h"
#include "gi/contract/light_lists.h"
#include "gi/lists/choose_lights.h"

namespace lambent {

class ListPass {
 public:
  /// Valid until the next run. Adds its rays to the count. `moved`: slots whose light is another than in the last run;
  /// `followed`: says by how much the light of tiles changed since then.
  const LightLists& run(ListInputs in, std::span<const uint32_t> moved, bool followed, uint64_t& rays);
  /// The next run's frame is not the one after the last's.
  void forget() { before_.clear(), changed_.clear(); }

 private:
  void keepChanges();

  ListTable table_;
  gl::Texture texture_, changes_;
  std::vector<float> before_; // W/sr, by slots
  std::vector<vec2> changed_; // as LightLists::changed
  LightLists lists_;
};

} // namespace lambent
