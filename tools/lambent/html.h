// Parts of reports that are one HTML page with everything inside it.
#pragma once

#include "engine/core/image.h"
#include "tools/lambent/text.h"

#include <filesystem>
#include <string>

namespace lambent {

/// For text inside HTML and SVG.
std::string escaped(const std::string& text);
/// Up to and with the heading.
std::string htmlHead(const std::string& title);
std::string htmlTable(const std::vector<TableColumn>& columns, const nlohmann::json& rows);
/// A picture (values as shown, 0 to 1) inside the page, and as folder/NAME.png.
std::string htmlPicture(const std::filesystem::path& folder, const std::string& name, const Image& shown,
                        const std::string& under);

} // namespace lambent
