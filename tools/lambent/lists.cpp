// lambent settings, techniques, content: what there is. Every setting with default, range and cost; the table of
// techniques, four axes a row, and what goes with what; the scenes that can be made, which are made.
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "gi/plan/techniques.h"
#include "tools/content/content.h"
#include "tools/lambent/commands.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <map>

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
      throw InputError("settings " + word,
                       "no setting has that word (" + guessText(word, names, "lambent settings") + ")");
    }
  std::vector<const SettingRow*> rows;
  for (size_t i = 0; i < table.size(); ++i)
    if (chosen[i]) rows.push_back(&table[i]);
  return rows;
}

/// Numbers with their range, choices with the list of them.
Value valueOf(const SettingRow& row) {
  Value j = Value::of("name", row.name, "unit", row.unit, "help", row.help, "changed", costText(row.change));
  if (row.choices.empty())
    j.update(Value::of("default", row.standard, "low", row.low, "high", row.high));
  else
    j.update(Value::of("default", row.text(row.standard), "choices", row.choices));
  return j;
}

void listSettings(const std::vector<std::string>& words, const OutputOptions& output) {
  Value figures = Value::list();
  for (const SettingRow* r : chosenRows(words)) {
    figures.add(valueOf(*r));
    if (!output.quiet)
      std::printf("%-26s %-12s %-16s %-8s %s%s%s\n", r->name.c_str(), r->text(r->standard).c_str(), r->range().c_str(),
                  r->unit, r->help.c_str(), r->change == ChangeCost::Nothing ? "" : "; changed: ",
                  r->change == ChangeCost::Nothing ? "" : costText(r->change));
  }
  writeJson(output.json, figures);
}

Value valueOf(const Technique& t) {
  return Value::of("name", t.name, "help", t.help, "source", rowOf(t.axes.source).name, "visibility",
                   rowOf(t.axes.visibility).name, "gather", rowOf(t.axes.gather).name, "reconstruction",
                   kReconstructions[int(t.axes.reconstruction)], "waits", t.waits ? t.waits : "");
}

void listTechniques(const OutputOptions& output) {
  Value j;
  for (const Technique& t : techniqueTable()) j["techniques"].add(valueOf(t));
  std::map<std::string, int> reasons;
  int together = 0;
  // Every combination of the first three axes, the light put together as the gather wants it.
  for (size_t s = 0; s < std::size(kSources); ++s)
    for (size_t v = 0; v < std::size(kVisibilities); ++v)
      for (size_t g = 0; g < std::size(kGathers); ++g) {
        const std::string reason =
            whyNot(Axes{VplSource(s), VplVisibility(v), GatherMode(g), reconstructionOf(GatherMode(g), true)});
        j["combinations"].add(Value::of("source", kSources[s].name, "visibility", kVisibilities[v].name, "gather",
                                        kGathers[g].name, "why_not", reason));
        ++(reason.empty() ? together : reasons[reason]);
      }
  writeJson(output.json, j);
  if (output.quiet) return;
  std::printf("%-16s %-6s %-11s %-12s %-17s %s\n", "technique", "lights", "visibility", "gathered", "put together", "");
  for (const Technique& t : techniqueTable()) {
    std::printf("%-16s %-6s %-11s %-12s %-17s %s\n", t.name, rowOf(t.axes.source).name, rowOf(t.axes.visibility).name,
                rowOf(t.axes.gather).name, kReconstructions[int(t.axes.reconstruction)], t.help);
    if (t.waits) std::printf("%-16s waits for the GPU: %s\n", "", t.waits);
  }
  const auto axis = [](const char* title, const auto& rows) {
    std::printf("\n%s\n", title);
    for (const auto& row : rows) std::printf("  %-22s %s\n", row.name, row.help);
  };
  axis("vpl.source", kSources);
  axis("vpl.visibility (maps and rays of lights from reflective maps read these back from the GPU)", kVisibilities);
  axis("gather.mode", kGathers);
  std::printf("\n%d combinations of these go together; the others do not:\n", together);
  for (const auto& [reason, count] : reasons) std::printf("  %s\n", reason.c_str());
  std::printf("\npapers: 1 Hedman et al. 2017, 2 Nichols and Wyman 2009, 3 Nichols et al. 2009, 4 Koa and Johan 2016,\n"
              "        5 Mertens and Van Reeth 2002 (their titles: README.md)\n");
}

void generate(const std::vector<std::string>& names, const OutputOptions& output) {
  std::vector<const ContentRecipe*> chosen;
  std::vector<std::string> known, bundled;
  for (const ContentRecipe& r : contentRecipes()) {
    known.push_back(r.name);
    if (r.bundled) bundled.push_back(r.name);
  }
  for (const std::string& name : names.empty() ? bundled : names) {
    const auto recipe = std::ranges::find(contentRecipes(), name, &ContentRecipe::name);
    if (recipe == contentRecipes().end())
      throw InputError("content " + name,
                       "no such scene (" + guessText(name, known, "see lambent content --help") + ")");
    chosen.push_back(&*recipe);
  }
  const std::filesystem::path base = resultFolder(output, output.out.empty() ? findContentFolder().string() : "");
  Value j = Value::list();
  for (const ContentRecipe* r : chosen) {
    if (!output.out.empty()) { // the bundled ones came without a list
      makeFolder(base / r->name);
      replaceOnlyOwnIn(base / r->name);
    }
    const GeneratedScene made = r->write(base / r->name);
    j.add(Value::of("name", r->name, "file", made.file.string(), "triangles", made.triangles, "bytes", made.bytes));
    if (!output.quiet)
      std::printf("%s: %llu triangles, %.1f KiB\n", made.file.c_str(), (unsigned long long)made.triangles,
                  double(made.bytes) / 1024);
  }
  writeJson(output.json, j);
}

} // namespace

void declareSettings(CLI::App& app) {
  auto words = std::make_shared<std::vector<std::string>>();
  auto output = std::make_shared<OutputOptions>();
  Command command(app, "settings", "every setting with default, range and cost");
  command.texts("WORD", *words, "only settings with this word in their name (smc, shadow.bias), else in their text");
  command.output(*output, "");
  command.run([words, output] { listSettings(*words, *output); });
}

void declareTechniques(CLI::App& app) {
  auto output = std::make_shared<OutputOptions>();
  Command command(app, "techniques", "the table of techniques, and what goes with what");
  command.output(*output, "");
  command.run([output] { listTechniques(*output); });
}

void declareContent(CLI::App& app) {
  auto names = std::make_shared<std::vector<std::string>>();
  auto output = std::make_shared<OutputOptions>();
  std::string known = "Scenes:";
  for (const ContentRecipe& r : contentRecipes())
    known += "\n  " + r.name + (r.bundled ? " (bundled): " : ": ") + r.description;
  Command command(app, "content", "generates scenes (default: the bundled ones)");
  command.footer(known);
  command.texts("NAME", *names, "scenes to make");
  command.output(*output, "folder to write to (default: the bundled scenes' own)");
  command.run([names, output] { generate(*names, *output); });
}

} // namespace lambent
