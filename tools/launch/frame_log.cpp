#include "tools/launch/frame_log.h"

#include "engine/core/error.h"

#include <cstdio>

namespace lambent {

void FrameLog::begin(const std::filesystem::path& file) {
  *this = {};
  file_ = file;
}

void FrameLog::add(double time, const FrameStats& stats, double writeMs, const Governed* governed) {
  const std::vector<FigureColumn> columns = columnsOf(stats);
  std::string line;
  if (rows_ == 0) {
    out_.open(file_);
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
  if (!(out_ << line << '\n').flush()) throw RunError(file_.string() + ": cannot be written (is the disk full?)");
  if (rows_++ > 0) ms_ += stats.wallMs + writeMs;
}

double FrameLog::framesPerSecond() const { return ms_ > 0 ? 1000 * double(rows_ - 1) / ms_ : 0; }

} // namespace lambent
