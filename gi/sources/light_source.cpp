#include "gi/sources/light_source.h"

#include "gi/reflective/reflective_source.h"
#include "gi/sources/sampled_source.h"

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
