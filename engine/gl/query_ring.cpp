#include "engine/gl/query_ring.h"

namespace lambent::gl {

void QueryRing::begin() {
  latest(); // frees those that are finished
  asking_ = pending_ < kQueries;
  if (!asking_) return;
  Query& query = queries_[(oldest_ + pending_) % kQueries];
  if (!query) query = Query(target_);
  glBeginQuery(target_, query.name());
}

void QueryRing::end() {
  if (!asking_) return;
  glEndQuery(target_);
  ++pending_;
  asking_ = false;
}

std::optional<uint64_t> QueryRing::latest() {
  for (; pending_ > 0; --pending_) {
    const std::optional<uint64_t> result = queries_[oldest_].known();
    if (!result) break;
    latest_ = result;
    oldest_ = (oldest_ + 1) % kQueries;
  }
  return latest_;
}

} // namespace lambent::gl
