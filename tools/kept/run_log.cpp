#include "tools/kept/run_log.h"

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "tools/kept/text_file.h"

#include <algorithm>
#include <fstream>

namespace lambent {

namespace {

constexpr double kMostSessions = 1e6;

std::string checkOf(const std::string& json) {
  Hash hash(1);
  hash.bytes(json.data(), json.size());
  return std::to_string(hash.result());
}

/// What a line holds; nothing where it is none of ours, or not whole.
Value runIn(const std::string& line) {
  Value run = Value::parsed(line);
  if (!run.isObject() || !run.has("check")) return {};
  const std::string check = run["check"].text();
  run.fields().erase("check");
  if (check != checkOf(run.json(-1)) || !run.has("key") || !run.has("conditions")) return {};
  return run;
}

} // namespace

std::string lineOf(Value run) {
  run.fields().erase("check");
  run["check"] = checkOf(run.json(-1));
  return run.json(-1);
}

RunLog::RunLog(std::filesystem::path file, std::string conditions)
    : file_(std::move(file)), conditions_(std::move(conditions)) {
  requireFileOrNothing(file_);
  checkWritable(file_);
  std::ifstream in(file_);
  int before = 0;
  for (std::string line; std::getline(in, line);) {
    const Value run = runIn(line);
    if (run.isNothing()) continue;
    before = std::max(before, int(std::clamp(run.numberOr("session", 0), 0.0, kMostSessions)));
    if (run["conditions"].text() == conditions_) runs_.push_back(run);
  }
  session_ = before + 1;
}

bool RunLog::has(const std::string& key) const {
  return std::ranges::any_of(runs_, [&](const Value& run) { return run["key"].text() == key; });
}

void RunLog::add(const std::string& key, Value run) {
  run.update(Value::of("key", key, "session", session_, "conditions", conditions_));
  listAsOwn(file_);
  std::ofstream out(file_, std::ios::app);
  out << (begun_ ? "" : "\n") << lineOf(run) << '\n'; // not behind half a line
  if (!out.flush()) throw RunError(file_.string() + ": cannot be written (is the folder writable, the disk full?)");
  begun_ = true;
  runs_.push_back(std::move(run));
}

} // namespace lambent
