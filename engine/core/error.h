// Error policy. A bug is a CheckFailure that says both values: programs let it end them (std::terminate prints it), the
// library makes it a status. Bad input is an InputError, shown as one line `error: FILE: what is wrong (what would be
// right)` and exit code 2. A failure at run time is a RunError, exit 1.
#pragma once

#include "engine/core/text.h"

#include <sstream>
#include <stdexcept>
#include <string>

namespace lambent {

/// What the user gave is wrong: a file, an option, a value. `what()` is the whole line without the leading "error: ".
struct InputError : std::runtime_error {
  InputError(const std::string& place, const std::string& reason)
      : std::runtime_error(printable(place + ": " + reason)) {}
};

/// The machine failed us: no context, disk full, a shader that does not compile at start.
struct RunError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A fault in this code. Who catches std::exception lets it through, or is at the border to a host.
struct CheckFailure : std::logic_error {
  using std::logic_error::logic_error;
};

template <class A, class B>
[[noreturn]] void checkFailed(const char* text, const A& a, const B& b, const char* file, int line) {
  std::ostringstream out;
  out << file << ":" << line << ": CHECK(" << text << ") failed: " << a << " against " << b;
  throw CheckFailure(out.str());
}

} // namespace lambent

#define CHECK(cond) ((cond) ? void() : ::lambent::checkFailed(#cond, "false", "true", __FILE__, __LINE__))
#define CHECK_EQ(a, b) ((a) == (b) ? void() : ::lambent::checkFailed(#a " == " #b, (a), (b), __FILE__, __LINE__))
#define CHECK_LT(a, b) ((a) < (b) ? void() : ::lambent::checkFailed(#a " < " #b, (a), (b), __FILE__, __LINE__))
#define CHECK_LE(a, b) ((a) <= (b) ? void() : ::lambent::checkFailed(#a " <= " #b, (a), (b), __FILE__, __LINE__))
