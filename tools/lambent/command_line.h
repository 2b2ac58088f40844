// A command's options, and how the command line answers a person: help that is read from the top, and guesses at what
// was misspelt. CLI11 is in command_line.cpp alone: it takes four seconds to compile, in every file that names it.
#pragma once

#include "engine/core/text.h"
#include "tools/launch/launch.h"

#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace lambent {

/// What every command has.
struct OutputOptions {
  std::string out, json;
  bool quiet = false;
};

/// Declares one command. What options are read into must outlive the parse.
class Command {
 public:
  Command(CLI::App& app, const std::string& name, const std::string& help);

  /// The options that all share that draw, but the scene.
  void launch(LaunchOptions& options);
  /// --out (unless its help is empty) with its standard, --json, --quiet.
  void output(OutputOptions& options, const std::string& outHelp, const std::string& standard = {});

  /// Files. The command is refused where one that is written is another one that is read or written.
  void reads(const std::string& name, std::string& file, const std::string& help, bool required = false);
  void reads(const std::string& name, std::vector<std::string>& files, const std::string& help, bool required = false);
  void writes(const std::string& name, std::string& file, const std::string& help);

  /// Named without dashes: what stands without a name. Must be given where `required`.
  void text(const std::string& name, std::string& value, const std::string& help, bool required = false);
  void texts(const std::string& name, std::vector<std::string>& values, const std::string& help, bool required = false);
  void choice(const std::string& name, std::string& value, const std::vector<std::string>& of, const std::string& help);
  /// Comma-separated; of these alone, where there are any.
  void list(const std::string& name, std::vector<std::string>& values, const std::string& help,
            const std::vector<std::string>& of = {});
  /// From the least to the most; any where these are the same.
  using Number = std::variant<int*, double*, std::optional<int>*, std::optional<double>*>;
  void number(const std::string& name, Number value, double least, double most, const std::string& help);
  void flag(const std::string& name, bool& value, const std::string& help);
  /// A flag that does something when it is given.
  void flag(const std::string& name, const std::function<void()>& given, const std::string& help);

  /// Of the options up to endForms at most one may be given.
  void beginForms();
  void endForms() { to_ = command_; }

  void footer(const std::string& text);
  /// What the command does once its options are read; throws InputError (exit 2) or RunError (exit 1).
  void run(const std::function<void()>& run);

 private:
  struct NamedFiles {
    std::string option;
    std::function<std::vector<std::string>()> names; // once they are parsed
    bool written;
  };
  static std::vector<std::string> writtenOf(const std::vector<NamedFiles>& files);

  CLI::App *command_, *to_;
  std::vector<NamedFiles> files_;
  LaunchOptions* launch_ = nullptr;
};

/// Parses and runs one of the commands that these functions declare; the exit code.
int runCommand(int argc, char** argv, const char* version, std::initializer_list<void (*)(CLI::App&)> commands);

} // namespace lambent
