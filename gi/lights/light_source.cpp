#include "gi/lights/light_source.h"

#include "gi/lights/reflective_source.h"
#include "gi/lights/sampled_source.h"

namespace lambent {

std::unique_ptr<LightSource> makeSource(VplSource source, PassContext context) {
  if (rowOf(source).sampled) return std::make_unique<SampledSource>(context);
  if (rowOf(source).reflective) return std::make_unique<ReflectiveSource>(context);
  return nullptr;
}

bool sameKind(VplSource a, VplSource b) {
  return rowOf(a).sampled == rowOf(b).sampled && rowOf(a).reflective == rowOf(b).reflective;
}

} // namespace lambent
