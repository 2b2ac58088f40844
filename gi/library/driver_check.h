// Whether this driver does what the passes ask of it.
#pragma once

#include <functional>
#include <string>

namespace lambent::library {

/// Runs every pass in the current context on a small room, and compares what it draws with rays on the CPU. Calls
/// `report` with one line for each. Returns whether all work. Leaves OpenGL's state as it was.
bool checkDriver(const std::function<void(bool works, const std::string& line)>& report);

} // namespace lambent::library
