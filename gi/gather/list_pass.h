// Lists of lights on the GPU, for gathers.
#pragma once

#include "engine/gl/objects.h"
#include "gi/contract/light_lists.h"
#include "gi/lists/choose_lights.h"

namespace lambent {

class ListPass {
 public:
  /// Valid until the next run. Adds its rays to the count.
  const LightLists& run(const ListInputs& in, uint64_t& rays);
  /// The lists of the last run, and the places that they were chosen for.
  const ListTable& table() const { return table_; }

 private:
  ListTable table_;
  gl::Texture texture_;
  LightLists lists_;
};

} // namespace lambent
