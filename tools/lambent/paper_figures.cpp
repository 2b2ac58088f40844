#include "tools/lambent/accuracy.h"

namespace lambent {

const std::vector<PaperFigure>& paperFigures() {
  const std::vector<std::string> both{"multires-splat", "multires-gather"}, gather{"multires-gather"};
  const Assignments papers{{"multires.criterion", "depth"},
                           {"multires.balance", "off"},
                           {"multires.edges", "off"},
                           {"multires.upsample", "bilinear"}};
  const auto with = [](Assignments all, const char* name, const char* value) {
    all.emplace_back(name, value);
    return all;
  };
  static const std::vector<PaperFigure> table{
      {.name = "2.table-1",
       .title = "frame rate by the size of the finest patches",
       .techniques = both,
       .x = {"multires.finest", {"1", "2", "4", "8"}}},
      {.name = "2.7",
       .title = "detail and frame rate by the threshold of normals, and detail put back (multires.detail)",
       .techniques = both,
       .x = {"multires.normal", {"0.05", "0.1", "0.25", "0.5", "1", "1.4", "2"}},
       .pictures = {{"normal-0.25", {{"multires.normal", "0.25"}}, "multires-gather"},
                    {"normal-1.4", {{"multires.normal", "1.4"}}, "multires-gather"},
                    {"normal-1.4-detail", {{"multires.normal", "1.4"}, {"multires.detail", "0.5"}}, "multires-gather"},
                    {"patches-0.25", {{"multires.normal", "0.25"}}, "multires-gather", Buffer::Patches},
                    {"patches-1.4", {{"multires.normal", "1.4"}}, "multires-gather", Buffer::Patches}},
       .curves = {kRate, kPatches, kError}},
      {.name = "2.8",
       .title = "frame rate by the number of VPLs and the size of the finest patches",
       .techniques = both,
       .x = {"rsm.vpls", {"64", "144", "256", "576", "1024"}},
       .series = {"multires.finest", {"1", "2", "4", "8", "16", "32"}},
       .truth = FigureTruth::None},
      {.name = "2.9",
       .title = "indirect light with little and with much refinement, and with detail put back",
       .techniques = both,
       .pictures = {{"normal-0.2", {{"multires.normal", "0.2"}}},
                    {"normal-1.5", {{"multires.normal", "1.5"}}},
                    {"normal-1.5-detail", {{"multires.normal", "1.5"}, {"multires.detail", "0.5"}}},
                    {"direct", {}, "multires-gather", Buffer::Direct}}},
      {.name = "3.10",
       .title = "frame rate and number of VPLs while the shot's lights move",
       .techniques = {"multires-gather", "isr", "hisr"},
       .truth = FigureTruth::None,
       .curves = {kRate, kLights},
       .overTime = true},
      {.name = "3.11",
       .title = "isr: frame rate by the threshold of depths in the maps and the finest clusters to begin with",
       .techniques = {"isr"},
       .x = {"rsm.depth", {"0.01", "0.02", "0.05", "0.1", "0.2", "0.5"}},
       .series = {"rsm.finest", {"64", "128", "256"}},
       .truth = FigureTruth::Texels,
       .curves = {kRate, kLights, kError}},
      {.name = "3.12",
       .title = "hisr: frame rate by the bound of a cluster's light and how deep trees are walked",
       .techniques = {"hisr"},
       .x = {"rsm.tau", {"0.001", "0.002", "0.004", "0.01", "0.03", "0.1"}},
       .series = {"rsm.finest", {"64", "128", "256"}},
       .truth = FigureTruth::Texels,
       .curves = {kRate, kError}},
      {.name = "3.combined",
       .title = "error of patches, of clusters, and of both, against every texel of the maps at every pixel",
       .techniques = {},
       .pictures = {{"patches", {{"rsm.finest", "1024"}, {"rsm.depth", "0"}}, "isr"},
                    {"isr-clusters", {{"gather.mode", "full"}}, "isr"},
                    {"hisr-clusters", {{"gather.mode", "full"}}, "hisr"},
                    {"isr-both", {}, "isr"},
                    {"hisr-both", {}, "hisr"}},
       .truth = FigureTruth::Texels},
      {.name = "criterion",
       .title = "patches split by distance from their plane, or by their range of depths (papers 2 and 3)",
       .techniques = gather,
       .x = {"multires.depth", {"0.005", "0.01", "0.02", "0.05", "0.1", "0.2", "0.5"}},
       .series = {"multires.criterion", {"plane", "depth"}},
       .pictures = {{"plane", {{"multires.criterion", "plane"}}},
                    {"depth", {{"multires.criterion", "depth"}}},
                    {"plane-patches", {{"multires.criterion", "plane"}}, "multires-gather", Buffer::Patches},
                    {"depth-patches", {{"multires.criterion", "depth"}}, "multires-gather", Buffer::Patches}},
       .curves = {kPatches, kError, kRate}},
      {.name = "upsampling",
       .title = "between patches: by how alike surfaces are, or bilinear (papers 2 and 3); papers: their criterion, "
                "neither balance nor edges",
       .techniques = gather,
       .pictures = {{"bilateral", {{"multires.upsample", "bilateral"}}},
                    {"bilinear", {{"multires.upsample", "bilinear"}}},
                    {"papers", papers},
                    {"papers-but-bilateral", with(papers, "multires.upsample", "bilateral")}}},
  };
  return table;
}

} // namespace lambent
