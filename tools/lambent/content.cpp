// lambent content [NAME...]: generates scenes, by default the bundled ones.
#include "tools/content/content.h"
#include "engine/core/error.h"
#include "engine/core/text.h"
#include "tools/lambent/commands.h"

#include <cstdio>

namespace lambent {

namespace {

void generate(const std::vector<std::string>& names, const OutputOptions& output) {
  std::vector<const ContentRecipe*> chosen;
  std::vector<std::string> known, bundled;
  for (const ContentRecipe& r : contentRecipes()) {
    known.push_back(r.name);
    if (r.bundled) bundled.push_back(r.name);
  }
  for (const std::string& name : names.empty() ? bundled : names) {
    const auto& all = contentRecipes();
    const auto it = std::find_if(all.begin(), all.end(), [&](const ContentRecipe& r) { return r.name == name; });
    if (it == all.end()) {
      const std::string near = nearestName(name, known);
      throw InputError("content " + name,
                       "no such scene (" +
                           (near.empty() ? "see lambent content --help" : "did you mean " + near + "?") + ")");
    }
    chosen.push_back(&*it);
  }
  const std::filesystem::path base = output.out.empty() ? findContentFolder() : std::filesystem::path(output.out);
  nlohmann::json j = nlohmann::json::array();
  for (const ContentRecipe* r : chosen) {
    const GeneratedScene made = r->write(base / r->name);
    j.push_back(
        {{"name", r->name}, {"file", made.file.string()}, {"triangles", made.triangles}, {"bytes", made.bytes}});
    if (!output.quiet)
      std::printf("%s: %llu triangles, %.1f KiB\n", made.file.c_str(), (unsigned long long)made.triangles,
                  double(made.bytes) / 1024);
  }
  writeJson(output.json, j);
}

} // namespace

void declareContent(CLI::App& app) {
  auto names = std::make_shared<std::vector<std::string>>();
  auto output = std::make_shared<OutputOptions>();
  std::string known = "Scenes:";
  for (const ContentRecipe& r : contentRecipes())
    known += "\n  " + r.name + (r.bundled ? " (bundled): " : ": ") + r.description;
  CLI::App* command = app.add_subcommand("content", "generates scenes (default: the bundled ones)");
  command->footer(known);
  command->add_option("NAME", *names, "scenes to make");
  addOutputOptions(*command, *output, "folder to write to (default: the bundled scenes' own)");
  command->callback([names, output] { generate(*names, *output); });
}

} // namespace lambent
