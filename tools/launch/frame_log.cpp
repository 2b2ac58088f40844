#include "tools/launch/frame_log.h"

#include "engine/core/error.h"
#include "engine/core/files.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

namespace lambent {

void FrameLog::add(double time, const FrameStats& stats, double writeMs, const Governed* governed) {
  rows_.push_back({time, stats, writeMs, governed ? governed->scale : 1, governed ? governed->preset : ""});
  governed_ |= governed != nullptr;
  for (const StageTime& t : stats.stages) stages_[t.stage.id] = true;
}

void FrameLog::write(const std::filesystem::path& file) const {
  writeAtomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary);
    out << "time_s,write_ms" << (governed_ ? ",scale,preset" : "");
    for (const FigureColumn& c : columnsOf(rows_.empty() ? FrameStats() : rows_[0].stats, stages_))
      out << ',' << c.name;
    out << '\n';
    for (const Row& row : rows_) {
      char text[64];
      std::snprintf(text, sizeof text, "%.6f,%.3f", row.time, row.writeMs);
      out << text;
      std::snprintf(text, sizeof text, ",%.4f,", double(row.scale));
      if (governed_) out << text << row.preset;
      for (const FigureColumn& c : columnsOf(row.stats, stages_)) out << ',' << c.text;
      out << '\n';
    }
    if (!out.flush()) throw RunError(file.string() + ": cannot be written");
  });
}

double FrameLog::framesPerSecond() const {
  double ms = 0;
  for (size_t i = 1; i < rows_.size(); ++i) ms += rows_[i].stats.wallMs + rows_[i].writeMs;
  return ms > 0 ? 1000 * double(rows_.size() - 1) / ms : 0;
}

} // namespace lambent
