#include "tools/launch/frame_log.h"

#include "engine/core/error.h"

#include <cstdio>

namespace lambent {

FrameLog::~FrameLog() {
  std::error_code ignored;
  if (out_ && (rows_ == 0 || written_ != file_)) std::filesystem::remove(written_, ignored);
}

void FrameLog::begin(const std::filesystem::path& file) {
  *this = {};
  file_ = file;
  removeLeftovers(file);
}

void FrameLog::add(double time, const FrameStats& stats, double writeMs, const Governed* governed) {
  const std::vector<FigureColumn> columns = columnsOf(stats);
  std::string line;
  if (rows_ == 0) {
    std::error_code none;
    written_ = std::filesystem::exists(std::filesystem::symlink_status(file_, none)) ? temporaryFor(file_) : file_;
    out_ = std::make_unique<AppendedFile>(written_);
    line = std::string("time_s,write_ms") + (governed ? ",scale,preset" : "");
    for (const FigureColumn& c : columns) line += ',' + c.name;
    line += '\n';
  }
  char text[64];
  std::snprintf(text, sizeof text, "%.6f,%.3f", time, writeMs);
  line += text;
  std::snprintf(text, sizeof text, ",%.4f,", governed ? double(governed->scale) : 1);
  if (governed) line += text + governed->preset;
  for (const FigureColumn& c : columns) line += ',' + c.text;
  out_->append(line + '\n');
  if (rows_++ > 0) ms_ += stats.wallMs + writeMs;
}

void FrameLog::end() {
  out_.reset();
  if (rows_ == 0 || written_ == file_) return;
  std::error_code failure;
  std::filesystem::rename(written_, file_, failure);
  if (failure) throw RunError(file_.string() + ": cannot be written: " + failure.message());
  written_ = file_;
}

double FrameLog::framesPerSecond() const { return ms_ > 0 ? 1000 * double(rows_ - 1) / ms_ : 0; }

} // namespace lambent
