// lambent techniques: the table of techniques, four axes a row, and what goes with what.
#include "gi/plan/techniques.h"
#include "tools/lambent/commands.h"

#include <cstdio>
#include <map>

namespace lambent {

namespace {

nlohmann::json jsonOf(const Technique& t) {
  return {{"name", t.name},
          {"help", t.help},
          {"source", rowOf(t.axes.source).name},
          {"visibility", rowOf(t.axes.visibility).name},
          {"gather", rowOf(t.axes.gather).name},
          {"reconstruction", kReconstructions[int(t.axes.reconstruction)]},
          {"waits", t.waits ? t.waits : ""}};
}

/// Every combination of the first three axes, the light put together as the gather wants it.
template <class Visit> void forAllCombinations(const Visit& visit) {
  for (size_t s = 0; s < std::size(kSources); ++s)
    for (size_t v = 0; v < std::size(kVisibilities); ++v)
      for (size_t g = 0; g < std::size(kGathers); ++g) {
        const Axes axes{VplSource(s), VplVisibility(v), GatherMode(g), reconstructionOf(GatherMode(g), true)};
        visit(axes, whyNot(axes));
      }
}

void listTechniques(const OutputOptions& output) {
  nlohmann::json j;
  for (const Technique& t : techniqueTable()) j["techniques"].push_back(jsonOf(t));
  std::map<std::string, int> reasons;
  int together = 0;
  forAllCombinations([&](const Axes& axes, const std::string& reason) {
    j["combinations"].push_back({{"source", rowOf(axes.source).name},
                                 {"visibility", rowOf(axes.visibility).name},
                                 {"gather", rowOf(axes.gather).name},
                                 {"why_not", reason}});
    if (reason.empty())
      ++together;
    else
      ++reasons[reason];
  });
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

} // namespace

void declareTechniques(CLI::App& app) {
  auto output = std::make_shared<OutputOptions>();
  CLI::App* command = app.add_subcommand("techniques", "the table of techniques, and what goes with what");
  addOutputOptions(*command, *output, "");
  command->callback([output] { listTechniques(*output); });
}

} // namespace lambent
