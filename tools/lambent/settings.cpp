// lambent settings [WORD...]: every knob with default, range and cost.
#include "engine/core/error.h"
#include "tools/lambent/commands.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

namespace lambent {

namespace {

/// Settings with one of the words in their name, else in what they say; all where there are no words. Throws InputError
/// for a word that is in none.
std::vector<const SettingRow*> chosenRows(const std::vector<std::string>& words) {
  const std::vector<SettingRow>& table = settingsTable();
  std::vector<bool> chosen(table.size(), words.empty());
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  const auto choose = [&](const std::string& word, std::string SettingRow::*text) {
    bool found = false;
    for (size_t i = 0; i < table.size(); ++i)
      if (!std::ranges::search(table[i].*text, word, {}, lower, lower).empty()) chosen[i] = found = true;
    return found;
  };
  for (const std::string& word : words)
    if (!choose(word, &SettingRow::name) && !choose(word, &SettingRow::help)) {
      std::vector<std::string> names;
      for (const SettingRow& row : table) names.push_back(row.name);
      const std::string near = nearestName(word, names);
      throw InputError("settings " + word, "no setting has that word (" +
                                               (near.empty() ? "lambent settings" : "did you mean " + near + "?") +
                                               ")");
    }
  std::vector<const SettingRow*> rows;
  for (size_t i = 0; i < table.size(); ++i)
    if (chosen[i]) rows.push_back(&table[i]);
  return rows;
}

/// Numbers with their range, choices with the list of them.
nlohmann::json jsonOf(const SettingRow& row) {
  nlohmann::json j = {{"name", row.name}, {"unit", row.unit}, {"help", row.help}, {"changed", costText(row.change)}};
  if (row.choices.empty())
    j.update({{"default", row.standard}, {"low", row.low}, {"high", row.high}});
  else
    j.update({{"default", row.text(row.standard)}, {"choices", row.choices}});
  return j;
}

void listSettings(const std::vector<std::string>& words, const OutputOptions& output) {
  nlohmann::json figures = nlohmann::json::array();
  for (const SettingRow* r : chosenRows(words)) {
    figures.push_back(jsonOf(*r));
    if (!output.quiet)
      std::printf("%-26s %-12s %-16s %-8s %s%s%s\n", r->name.c_str(), r->text(r->standard).c_str(), r->range().c_str(),
                  r->unit, r->help.c_str(), r->change == ChangeCost::Nothing ? "" : "; changed: ",
                  r->change == ChangeCost::Nothing ? "" : costText(r->change));
  }
  writeJson(output.json, figures);
}

} // namespace

void declareSettings(CLI::App& app) {
  auto words = std::make_shared<std::vector<std::string>>();
  auto output = std::make_shared<OutputOptions>();
  CLI::App* command = app.add_subcommand("settings", "every setting with default, range and cost");
  command->add_option("WORD", *words,
                      "only settings with this word in their name (smc, shadow.bias), else in their text");
  addOutputOptions(*command, *output, "");
  command->callback([words, output] { listSettings(*words, *output); });
}

} // namespace lambent
