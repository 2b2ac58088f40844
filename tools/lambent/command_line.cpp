#include "tools/lambent/command_line.h"

#include "engine/core/error.h"
#include "engine/core/files.h"

#include <CLI/CLI.hpp>

#include <algorithm>

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

std::string guessOrHelp(const std::string& name, const std::vector<std::string>& known, const std::string& help) {
  const std::string guess = guessText(name, known, "");
  return guess + (guess.empty() ? "see " : " see ") + help;
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
  return "no option " + option + " (" + guessOrHelp(option, known, "lambent " + command.get_name() + " --help") + ")";
}

/// Throws InputError, with the nearest name, where the first word is no command: CLI11 would say only that one is
/// needed.
void checkCommand(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  const std::string name = argv[1];
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  if (std::ranges::find(known, name) != known.end()) return;
  throw InputError("command line", "no command " + name + " (" + guessOrHelp(name, known, "lambent --help") + ")");
}

/// What CLI11 found wrong, in one line that says where help is; of an unknown option, with the nearest name.
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

} // namespace

Command::Command(CLI::App& app, const std::string& name, const std::string& help)
    : command_(app.add_subcommand(name, help)), to_(command_) {}

void Command::launch(LaunchOptions& options) {
  addLaunchOptions(*command_, options);
  launch_ = &options;
  files_.push_back({"--cube-file", [&options] { return std::vector{options.cube}; }, true});
}

void Command::output(OutputOptions& options, const std::string& outHelp, const std::string& standard) {
  options.out = standard;
  if (!outHelp.empty()) writes("--out", options.out, outHelp);
  writes("--json", options.json, "write the figures to this file, for programs");
  to_->get_option("--json")->check([](const std::string& file) { // before the work
    checkWritable(file);
    return std::string();
  });
  flag("--quiet", options.quiet, "print nothing but errors");
}

void Command::reads(const std::string& name, std::string& file, const std::string& help, bool required) {
  text(name, file, help, required);
  files_.push_back({name, [&file] { return std::vector{file}; }, false});
}
void Command::reads(const std::string& name, std::vector<std::string>& files, const std::string& help, bool required) {
  texts(name, files, help, required);
  files_.push_back({name, [&files] { return files; }, false});
}
void Command::writes(const std::string& name, std::string& file, const std::string& help) {
  text(name, file, help);
  files_.push_back({name, [&file] { return std::vector{file}; }, true});
}

/// Names of what is written. Throws InputError where one of two results, or what is read, would be lost.
std::vector<std::string> Command::writtenOf(const std::vector<NamedFiles>& files) {
  std::vector<std::string> written;
  const auto one = [](const std::string& a, const std::string& b) {
    return !a.empty() && !b.empty() && sameFile(a, b);
  };
  for (size_t i = 0; i < files.size(); ++i)
    for (const std::string& name : files[i].names()) {
      if (files[i].written && !name.empty()) written.push_back(name);
      for (size_t k = 0; k < i; ++k)
        for (const std::string& other : files[k].names())
          if ((files[i].written || files[k].written) && one(name, other))
            throw InputError(name, files[k].option + " and " + files[i].option +
                                       " name this one file (give one of them another name)");
    }
  return written;
}

void Command::text(const std::string& name, std::string& value, const std::string& help, bool required) {
  to_->add_option(name, value, help)->required(required);
}
void Command::choice(const std::string& name, std::string& value, const std::vector<std::string>& of,
                     const std::string& help) {
  to_->add_option(name, value, help)->check(CLI::IsMember(of));
}
void Command::texts(const std::string& name, std::vector<std::string>& values, const std::string& help, bool required) {
  to_->add_option(name, values, help)->required(required);
}
void Command::list(const std::string& name, std::vector<std::string>& values, const std::string& help,
                   const std::vector<std::string>& of) {
  CLI::Option* option = to_->add_option(name, values, help)->delimiter(',');
  if (!of.empty()) option->check(CLI::IsMember(of));
}
void Command::number(const std::string& name, Number value, double least, double most, const std::string& help) {
  std::visit(
      [&](auto* to) {
        CLI::Option* option = to_->add_option(name, *to, help);
        const bool whole = std::is_same_v<decltype(to), int*> || std::is_same_v<decltype(to), std::optional<int>*>;
        if (least < most) option->check(whole ? CLI::Range(int(least), int(most)) : CLI::Range(least, most));
      },
      value);
}
void Command::flag(const std::string& name, bool& value, const std::string& help) { to_->add_flag(name, value, help); }
void Command::flag(const std::string& name, const std::function<void()>& given, const std::string& help) {
  to_->add_flag_callback(name, given, help);
}

void Command::beginForms() { to_ = command_->add_option_group("Forms", "at most one")->require_option(0, 1); }
void Command::footer(const std::string& text) { command_->footer(text); }
void Command::run(const std::function<void()>& run) {
  command_->callback([files = files_, launch = launch_, run] {
    std::vector<std::string> written = writtenOf(files);
    if (launch) launch->written = std::move(written);
    run();
  });
}

int runCommand(int argc, char** argv, const char* version, std::initializer_list<void (*)(CLI::App&)> commands) {
  CLI::App app{"Lambent: global illumination for moving worlds", "lambent"};
  app.formatter(std::make_shared<TopDownHelp>());
  app.set_version_flag("--version", version, "name and version, and nothing else");
  app.require_subcommand(1);
  for (const auto& declare : commands) declare(app);
  for (CLI::App* command : app.get_subcommands({})) refuseUnusable(*command);
  try {
    chooseShaders();
    checkCommand(app, argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::Success& e) { // help, version
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    std::fprintf(stderr, "error: %s\n", textOf(e, app).c_str());
    return 2;
  } catch (const InputError& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    return 2;
  } catch (const CheckFailure&) {
    throw; // ends the program, which says what
  } catch (const std::exception& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    return 1;
  }
  return 0;
}

} // namespace lambent
