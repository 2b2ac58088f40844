// Small text helpers for messages to people.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace lambent {

/// Text from a file as a terminal may show it: control characters (line feeds too) become \xNN, other bytes stay. What is
/// longer than anybody reads has its middle left out.
std::string printable(std::string_view text);

/// The candidate with the fewest single-letter edits to `name` (case ignored), the first of equals; empty when there
/// are no candidates or when even the best would have to be mostly rewritten, so that a guess would mislead.
std::string nearestName(std::string_view name, std::span<const std::string> candidates);

/// "did you mean NEAR?", or `otherwise` where no name is near.
std::string guessText(std::string_view name, std::span<const std::string> known, const std::string& otherwise);

/// "a, b, c".
std::string joined(std::span<const std::string> names);

} // namespace lambent
