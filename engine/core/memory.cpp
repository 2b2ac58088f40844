#include "engine/core/memory.h"

namespace lambent {

namespace {
thread_local MemoryAccount* accountAround = nullptr;
} // namespace

void MemoryAccount::enter(const std::string& owner, bool gpu, int64_t bytes) {
  const std::lock_guard lock(mutex_);
  const auto at = bytes_.try_emplace({owner, gpu}, 0).first;
  if ((at->second += uint64_t(bytes)) == 0) bytes_.erase(at);
}

std::vector<MemoryAccount::Row> MemoryAccount::rows() const {
  const std::lock_guard lock(mutex_);
  std::vector<Row> rows;
  for (const auto& [key, bytes] : bytes_) rows.push_back({key.first, key.second, bytes});
  return rows;
}

MemoryAccount& MemoryAccount::current() {
  static MemoryAccount ofProcess;
  return accountAround ? *accountAround : ofProcess;
}

MemoryAccount::Scope::Scope(MemoryAccount& account) : before_(accountAround) { accountAround = &account; }
MemoryAccount::Scope::~Scope() { accountAround = before_; }

} // namespace lambent
