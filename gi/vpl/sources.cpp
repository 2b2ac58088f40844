#include "gi/vpl/sources.h"

namespace lambent {

VplChanges placeVpls(VplSource, VplSet& set, const VplUpdate& in, VplUpdateLog& log,
                     const std::function<void(int, int)>& progress) {
  return updateVpls(set, in, log, progress);
}

} // namespace lambent
