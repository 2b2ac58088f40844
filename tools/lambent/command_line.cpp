#include "tools/lambent/command_line.h"

#include "engine/core/error.h"

#include <vector>

namespace lambent {

namespace {

constexpr size_t kNameColumns = 32, kTextColumns = 78;

std::string wrapped(const std::string& text, size_t columns) {
  std::string out;
  size_t used = 0;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find_first_of(" \n", at), text.size());
    if (used > 0 && used + 1 + (end - at) > columns) {
      out += '\n';
      used = 0;
    } else if (used > 0) {
      out += ' ';
      ++used;
    }
    out.append(text, at, end - at);
    used += end - at;
    if (end < text.size() && text[end] == '\n') {
      out += '\n';
      used = 0;
    }
    at = end + 1;
  }
  return out;
}

class TopDownHelp : public CLI::Formatter {
 public:
  TopDownHelp() { column_width(kNameColumns); }

  /// As CLI11's, but for groups of options that exclude each other: they stand before all others, not at the end.
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string forms;
    for (const CLI::App* group : app->get_subcommands({}))
      if (group->get_name().empty())
        forms += make_group(group->get_group() + ", " + group->get_description(), false,
                            group->get_options([&](const CLI::Option* o) { return o != group->get_help_ptr(); }));
    if (forms.empty()) return CLI::Formatter::make_help(app, name, mode);
    return make_description(app) + make_usage(app, name) + make_positionals(app) + forms + make_groups(app, mode) +
           '\n' + make_footer(app);
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    return wrapped(CLI::Formatter::make_option_desc(option), kTextColumns);
  }
};

std::string guessText(const std::string& near, const std::string& help) {
  return near.empty() ? "see " + help : "did you mean " + near + "? see " + help;
}

/// Of a command and its groups.
void collectOptions(const CLI::App& command, std::vector<std::string>& names) {
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* group : command.get_subcommands({}))
    if (group->get_name().empty()) collectOptions(*group, names);
}

std::string unknownOptionText(const CLI::App& command, const std::string& option) {
  std::vector<std::string> known;
  collectOptions(command, known);
  return "no option " + option + " (" +
         guessText(nearestName(option, known), "lambent " + command.get_name() + " --help") + ")";
}

} // namespace

std::shared_ptr<CLI::Formatter> helpFormatter() { return std::make_shared<TopDownHelp>(); }

void checkCommand(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  const std::string name = argv[1];
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  if (std::ranges::find(known, name) != known.end()) return;
  throw InputError("command line",
                   "no command " + name + " (" + guessText(nearestName(name, known), "lambent --help") + ")");
}

std::string textOf(const CLI::ParseError& error, const CLI::App& app) {
  std::string help = "lambent --help";
  for (const CLI::App* command : app.get_subcommands()) {
    help = "lambent " + command->get_name() + " --help";
    for (const std::string& word : command->remaining())
      if (word.starts_with("--"))
        return "command line: " + printable(unknownOptionText(*command, word.substr(0, word.find('='))));
  }
  std::string text = error.what();
  for (char& c : text)
    if (c == '\n') c = ' ';
  return "command line: " + printable(text) + " (see " + help + ")";
}

} // namespace lambent
