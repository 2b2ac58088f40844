// lambent accuracy SCENE --figure NAME: figures of the papers for any scene. Paper 1's figs. 8, 9 and 10 here: pictures
// of one set of virtual lights, or of sets of several sizes, held to path tracing or to a ray for every pair. Its fig.
// 7 is `lambent stability`.
#include "engine/core/error.h"
#include "tools/lambent/linear_picture.h"
#include "tools/lambent/reflective_figures.h"
#include "tools/lambent/study.h"

#include <algorithm>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

namespace {

struct Drawn {
  std::string name;
  Assignments assignments;
};

struct PathFigure {
  std::vector<Drawn> drawn;
  std::vector<std::string> traced; // what all are held to; none: the first that is drawn
  bool twiceShown = false;         // differences are of what is shown, times 2; else of radiance
};

constexpr const char *kTraced = "path-tracing", *kTracedClamped = "clamped-path-tracing";

PathFigure pathFigure(const std::string& name, bool quick) {
  const auto maps = [](const char* texels) {
    return Drawn{std::string("maps-") + texels, {{"gather.mode", "full"}, {"shadow.resolution", texels}}};
  };
  const auto lights = [](const char* vpls) {
    return Drawn{std::string("vpls-") + vpls, {{"vpl.visibility", "rays"}, {"smc.vpls", vpls}}};
  };
  const Drawn rays{"rays", {{"vpl.visibility", "rays"}}};
  if (name == "1.8")
    return {{{"interleaved", {}}, {"all-maps", {{"gather.mode", "full"}}}, {"all-rays", rays.assignments}},
            {kTraced, kTracedClamped}};
  if (name == "1.9") {
    std::vector<Drawn> drawn{rays, maps("128"), maps("256")};
    if (!quick) drawn.insert(drawn.end(), {maps("512"), maps("1024")});
    return {drawn, {}};
  }
  if (quick) return {{lights("64"), lights("256")}, {kTraced, kTracedClamped}, true};
  return {{lights("2000"), lights("8000"), lights("40000")}, {kTraced, kTracedClamped}, true};
}

void drawPathFigure(const AccuracyOptions& options, const std::string& name) {
  const PathFigure figure = pathFigure(name, options.quick);
  if (!figure.traced.empty()) needClamp(options);
  const fs::path folder = reportFolder(options.output.out, "out/figure-" + name);
  Study study(options, "320x180", {{"gather.disk", "0"}, {"gather.near", "0"}, {"history.frames", "0"}});
  std::vector<std::pair<std::string, Image>> truths;
  for (const std::string& traced : figure.traced)
    truths.emplace_back(
        traced, study.trace(1024, ReferenceBuffer::Indirect, traced == kTracedClamped, folder / (traced + ".state"))
                    .picture.mean);
  std::vector<Variant> variants;
  for (const Drawn& d : figure.drawn) variants.push_back(study.variant(d.name, d.assignments));
  std::vector<Measured> runs = study.draw(variants, Buffer::Indirect);
  const float exposure = study.truth ? study.truth->exposure : runs[0].exposure;
  if (truths.empty()) {
    truths.emplace_back(runs[0].variant.name, runs[0].picture);
    runs.erase(runs.begin());
  }

  const auto write = [&](const std::string& picture, const Image& image) {
    for (const char* extension : {".exr", ".png"})
      writePicture((folder / (picture + extension)).string(), image, exposure);
  };
  nlohmann::json rows;
  for (const auto& [picture, truth] : truths) write(picture, truth);
  for (const Measured& m : runs) {
    write(m.variant.name, m.picture);
    for (const auto& [against, truth] : truths) {
      const PictureError error = pictureError(m.picture, truth);
      rows.push_back(rowOf(error));
      rows.back().update({{"picture", m.variant.name}, {"against", against}});
      const std::string file = (folder / (m.variant.name + "-minus-" + against + ".png")).string();
      if (figure.twiceShown)
        writeShown(file, absoluteDifference(shownImage(m.picture, exposure), shownImage(truth, exposure), 2));
      else
        writePicture(file, absoluteDifference(m.picture, truth), midGreyAt(error.meanTruth));
    }
  }
  writeText(folder / "figure.csv", csvText(rows));
  study.report({{"picture", "picture"}, {"against", "against"}, kRmseShare, kRelMse, kBias}, rows);
  if (!options.output.quiet) std::printf("pictures: %s\n", folder.c_str());
}

/// Of paper 1, by number alone as well.
const std::vector<std::string> kPathFigures{"1.8", "1.9", "1.10", "8", "9", "10"};

} // namespace

std::vector<std::string> figureNames() {
  std::vector<std::string> names = kPathFigures;
  for (const std::string& name : reflectiveFigureNames()) names.push_back(name);
  return names;
}

void accuracyFigure(const AccuracyOptions& options) {
  const std::string& name = options.figure;
  if (std::ranges::count(kPathFigures, name) == 0) return reflectiveFigure(options);
  drawPathFigure(options, name.starts_with("1.") ? name : "1." + name);
}

} // namespace lambent
