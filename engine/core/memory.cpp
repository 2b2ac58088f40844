#include "engine/core/memory.h"

#include <algorithm>
#include <functional>

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

void HeldMemory::now(uint64_t bytes) {
  if (bytes == bytes_) return;
  if (!account_) account_ = &MemoryAccount::current();
  account_->enter(owner_, false, int64_t(bytes - bytes_));
  bytes_ = bytes;
}

std::string moreThanIsLeft(double bytes, const std::string& cure) {
  constexpr uint64_t kWorthNaming = 100'000'000;
  constexpr size_t kMostNamed = 4;
  std::vector<MemoryAccount::Row> rows = MemoryAccount::current().rows();
  std::erase_if(rows, [](const MemoryAccount::Row& row) { return row.bytes < kWorthNaming; });
  std::ranges::sort(rows, std::greater(), &MemoryAccount::Row::bytes);
  rows.resize(std::min(rows.size(), kMostNamed));
  std::string held;
  for (const MemoryAccount::Row& row : rows) {
    const uint64_t tenths = row.bytes / kWorthNaming;
    held += (held.empty() ? "; held: " : ", ") + row.owner + " " + std::to_string(tenths / 10) + "." +
            std::to_string(tenths % 10) + " GB";
  }
  return std::to_string(uint64_t(bytes / 1e9) + 1) + " GB of memory, more than is left (" + cure + held + ")";
}

} // namespace lambent
