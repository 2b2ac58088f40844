// How the command line answers a person: help that is read from the top, and guesses at what was misspelt.
#pragma once

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

namespace lambent {

/// Lines of help end before a terminal does.
std::shared_ptr<CLI::Formatter> helpFormatter();

/// Throws InputError, with the nearest name, where the first word is no command: CLI11 would say only that one is
/// needed.
void checkCommand(const CLI::App& app, int argc, char** argv);

/// What CLI11 found wrong, in one line that says where help is; of an unknown option, with the nearest name.
std::string textOf(const CLI::ParseError& error, const CLI::App& app);

} // namespace lambent
