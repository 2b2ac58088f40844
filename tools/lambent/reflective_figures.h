// Figures of papers 2 and 3.
#pragma once

#include "tools/lambent/accuracy.h"

#include <string>
#include <vector>

namespace lambent {

/// As --figure takes them: "2.7".
std::vector<std::string> reflectiveFigureNames();
/// Draws the one that the options name: table, plot and pictures into the folder.
void reflectiveFigure(const AccuracyOptions& options);

} // namespace lambent
