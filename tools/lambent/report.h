// Text that reports are made of: tables in Markdown, CSV and HTML, and the files that hold them.
#pragma once

#include "engine/image/image.h"
#include "tools/kept/text_file.h"
#include "tools/kept/value.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lambent {

class GlContext;
struct OutputOptions;

/// As printf, up to 255 characters.
std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));
/// The name of a scene or shot: its file's, without folder and extension.
std::string nameOf(const std::string& file);

/// A column of a table whose rows are objects. Texts are taken as they are, lists are joined by commas, and what lacks
/// stays empty.
struct TableColumn {
  const char *key, *title;
  const char* pattern = "%g";   // of one number
  double factor = 1;            // on it, as 100 for per cent
  const char* ofZero = nullptr; // what stands for 0
};
/// In Markdown.
std::string tableText(const std::vector<TableColumn>& columns, const Value& rows);
/// All that is one number or text, by key.
std::string csvText(const Value& rows);

/// For text inside HTML and SVG.
std::string escaped(const std::string& text);
/// Of a page with everything inside it, up to and with the heading.
std::string htmlHead(const std::string& title);
std::string htmlTable(const std::vector<TableColumn>& columns, const Value& rows);
/// A picture (values as shown, 0 to 1) inside the page, and as folder/NAME.png.
std::string htmlPicture(const std::filesystem::path& folder, const std::string& name, const Image& shown,
                        const std::string& under);

/// Processor, OpenGL renderer, day.
std::string machineText(const GlContext& context);

/// Writes figures for programs, and keeps the report's other files from replacing them; nothing when `file` is empty.
void writeJson(const std::string& file, const Value& figures);

/// NAME.md with the heading and the text, NAME.csv, and the figures for programs, all in the folder; the text is
/// printed too, unless quiet.
void writeReport(const OutputOptions& output, const std::filesystem::path& folder, const std::string& name,
                 const std::string& heading, const std::string& text, const std::string& csv, const Value& figures);

/// Throws InputError where two files are called the same, wherever they lie: results are named by them.
void refuseNamesakes(const std::vector<std::string>& files);

/// The folder that results go to: --out, or `unnamed` where that is empty; made where it lacks, and nothing is written
/// through links in it. Throws RunError, and InputError where --json may have the name of a result there: but
/// recording.json, which `record` looks after itself, none of them ends in .json.
std::filesystem::path resultFolder(const OutputOptions& output, const std::string& unnamed);
/// The folder of a report, which writes these names among others: of what is there only what earlier reports wrote is
/// replaced. Throws as resultFolder, and InputError where one of the names is somebody's.
std::filesystem::path reportFolder(const OutputOptions& output, const std::string& unnamed,
                                   const std::vector<std::string>& names);

} // namespace lambent
