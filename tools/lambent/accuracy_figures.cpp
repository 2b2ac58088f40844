// lambent accuracy SCENE --figure 1.N: what paper 1 draws. Figs. 8, 9 and 10 compare pictures of one view with path
// tracing or with a ray for every pair; figs. 3 and 5 look at frames of a shot that follow each other. Its fig. 7 is
// `lambent stability`. 5.5: pictures from paper 5's cubes, compared with those of a ray for every pair.
#include "engine/core/error.h"
#include "gi/plan/techniques.h"
#include "gi/vpl/vpl_set.h"
#include "tools/lambent/accuracy.h"
#include "tools/lambent/picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lambent {

namespace fs = std::filesystem;

const Assignments kPlain{{"gather.disk", "0"}, {"gather.near", "0"}, {"history.frames", "0"}, {"gather.glossy", "off"}};

void needClamp(const AccuracyOptions& options) {
  if (!(options.clamp.value_or(0) > 0))
    throw InputError("--clamp", "is needed here (largest geometry term on both sides, in 1/m^2: --clamp 10)");
}

namespace {

/// Pictures of one set of virtual lights, or of sets of several sizes.
struct PathFigure {
  struct Drawn {
    std::string name;
    Assignments set;
    std::string technique = {}; // empty: as set
  };
  std::vector<Drawn> drawn;
  std::vector<std::string> traced; // what all are compared with; none: the first that is drawn
  bool twiceShown = false;         // differences are of what is shown, times 2; else of radiance
};

constexpr const char *kTraced = "path-tracing", *kTracedClamped = "clamped-path-tracing";

PathFigure comparedPictures(const std::string& name, bool quick) {
  if (name == "1.8")
    return {{{"interleaved", {{"gather.mode", "interleaved"}}},
             {"all-maps", {{"gather.mode", "full"}}},
             {"all-rays", {{"vpl.visibility", "rays"}}}},
            {kTraced, kTracedClamped}};
  if (name == "5.5") {
    PathFigure figure{{{"rays", {{"vpl.visibility", "rays"}, {"filter.on", "off"}, {"gather.disk", "1"}}, "ir"}}, {}};
    for (const char* texels : {"32", "64", "128", "256", "512"})
      if (!quick || figure.drawn.size() < 3)
        figure.drawn.push_back(
            {std::string("cube-") + texels, {{"cube.resolution", texels}, {"gather.disk", "1"}}, "ibrr"});
    return figure;
  }
  PathFigure figure{{}, {kTraced, kTracedClamped}, true};
  if (name == "1.9") {
    figure = {{{"rays", {{"vpl.visibility", "rays"}}}}, {}};
    for (const char* texels : {"128", "256", "512", "1024"})
      if (!quick || figure.drawn.size() < 3)
        figure.drawn.push_back(
            {std::string("maps-") + texels, {{"gather.mode", "full"}, {"shadow.resolution", texels}}});
    return figure;
  }
  using Texts = std::vector<std::string>;
  for (const std::string& vpls : quick ? Texts{"64", "256"} : Texts{"2000", "8000", "40000"})
    figure.drawn.push_back({"vpls-" + vpls, {{"vpl.visibility", "rays"}, {"smc.vpls", vpls}}});
  return figure;
}

void drawPathFigure(const AccuracyOptions& options, const std::string& name) {
  const PathFigure figure = comparedPictures(name, options.quick);
  if (!figure.traced.empty()) needClamp(options);
  const fs::path folder = reportFolder(options.output, "out/figure-" + name, {"figure.csv"});
  Study study(options, options.launch.scene, {.size = "320x180", .set = kPlain});
  std::vector<std::pair<std::string, Image>> truths;
  for (const std::string& traced : figure.traced) {
    study.trace(1024, ReferenceBuffer::Indirect, traced == kTracedClamped, folder / (traced + ".state"));
    truths.emplace_back(traced, study.truth);
  }
  std::vector<Variant> variants;
  for (const PathFigure::Drawn& d : figure.drawn) variants.push_back(study.variant(d.name, d.set, d.technique));
  std::vector<Measured> runs = study.draw(variants, Buffer::Indirect);
  const float exposure = study.traced ? study.traced->exposure : runs[0].exposure;
  if (truths.empty()) {
    truths.emplace_back(runs[0].variant.name, runs[0].image);
    runs.erase(runs.begin());
  }

  const auto write = [&](const std::string& picture, const Image& image) {
    for (const char* extension : {".exr", ".png"})
      writePicture((folder / (picture + extension)).string(), image, exposure);
  };
  const std::vector<Column> columns{
      {{"picture", "picture"}, variantName}, {{"against", "against"}}, kRmseShare, kRelMse, kBias};
  Value rows;
  for (const auto& [picture, truth] : truths) write(picture, truth);
  for (const Measured& m : runs) {
    write(m.variant.name, m.image);
    for (const auto& [against, truth] : truths) {
      study.compareWith(truth);
      rows.add(study.row(columns, m))["against"] = against;
      const std::string file = (folder / (m.variant.name + "-minus-" + against + ".png")).string();
      if (figure.twiceShown)
        writeShown(file, absoluteDifference(shownImage(m.image, exposure), shownImage(truth, exposure), 2));
      else
        writePicture(file, absoluteDifference(m.image, truth), midGreyAt(study.outcome(m).error.meanTruth));
    }
  }
  writeText(folder / "figure.csv", csvText(rows));
  study.report(columns, rows);
  if (!options.output.quiet) std::printf("pictures: %s\n", folder.c_str());
}

/// The shot up to --frame, and the frames before it that a figure shows too. Throws InputError where it has none.
RunPlan upTo(Study& study, const AccuracyOptions& options, int before) {
  if (!study.opened->shot) throw InputError(study.launch.scene, "not a shot (a .json file, with what moves)");
  RunPlan plan = planOf(*study.opened, 0);
  const int last = options.frame > 0 ? options.frame : plan.frames / 2;
  if (last < before || last >= plan.frames)
    throw InputError("--frame", format("is not within %d and %d", before, plan.frames - 1));
  plan.frames = last + 1;
  plan.inTurn = false;
  plan.buffer = Buffer::Indirect;
  for (int f = last - before; f < last; ++f) plan.also.push_back(f);
  return plan;
}

/// A dot of a picture in rows from the bottom, as wide as it needs to be seen.
void dot(Image& picture, const vec2& at, const vec3& color) {
  const int reach = std::max(1, picture.height / 240);
  for (int y = int(at.y) - reach; y <= int(at.y) + reach; ++y)
    for (int x = int(at.x) - reach; x <= int(at.x) + reach; ++x)
      if (x >= 0 && y >= 0 && x < picture.width && y < picture.height) picture.at(x, picture.height - 1 - y) = color;
}

/// The scene from above, cut open at the height of the camera, with the virtual lights that a technique places for the
/// camera (dark to bright yellow by intensity) and the sides of what it sees (green).
Image overhead(const Variant& variant, const SceneView& view) {
  constexpr int kSide = 480;
  Viewer gi(variant.settings, variant.seed);
  gi.run(view);
  const VplSet lights = gi.vpls();

  SceneView above = view;
  const vec3 eye = view.camera.position(), size = view.boundsWorld.size(), middle = view.boundsWorld.centre();
  const float half = 0.52f * std::max(size.x, size.z);
  const mat4& m = view.camera.worldFromView;
  above.camera.worldFromView =
      mat4(vec4(1, 0, 0, 0), vec4(0, 0, -1, 0), vec4(0, 1, 0, 0), vec4(middle.x, eye.y + 0.02f * size.y, middle.z, 1));
  above.camera.orthoHalfHeight = half;
  above.camera.near = 1e-3f * size.y;
  above.camera.width = above.camera.height = kSide;
  Variant plain = variant;
  plain.settings.effects[EffectId::Indirect] = EffectMode::Off;
  const std::unique_ptr<Runner> runner = wholeFrames(plain);
  runner->run(above);
  Image picture = runner->image(Buffer::Albedo);
  for (vec3& p : picture.pixels) p = 0.35f * shownImage(Image(1, 1, {p}), 1).pixels[0];
  const auto at = [&](const vec3& p) {
    return (vec2(p.x - middle.x, middle.z - p.z) / half * 0.5f + 0.5f) * float(kSide);
  };
  double brightest = 0;
  for (const Vpl& v : lights.slots)
    if (v.alive) brightest = std::max(brightest, double(v.intensity()));
  for (const Vpl& v : lights.slots)
    if (v.alive) {
      const float share = std::pow(float(double(v.intensity()) / brightest), 0.25f);
      dot(picture, at(v.position), vec3(1, 1, 0.2f) * (0.25f + 0.75f * share));
    }
  const float aspect = float(view.camera.width) / float(view.camera.height), up = std::tan(0.5f * view.camera.fovY);
  for (const float side : {-1.0f, 1.0f})
    for (int i = 0; i < 400; ++i) {
      const vec3 way = vec3(m * vec4(side * aspect * up, 0, -1, 0));
      dot(picture, at(eye + way * (2 * half * float(i) / 400)), vec3(0.1f, 0.8f, 0.1f));
    }
  return picture;
}

/// Mean step of a pixel from the frame before, over the mean.
Value meanStep(const Outcome& o) {
  double step = 0, light = 0;
  for (size_t i = 0; i < o.run.image.pixels.size(); ++i) {
    const float now = luminance(o.run.image.pixels[i]);
    step += double(std::abs(now - luminance(o.run.before[0].pixels[i])));
    light += double(now);
  }
  return light > 0 ? step / light : 0;
}

/// Fig. 3: how much of a picture changes from one frame to the next while a light moves, and where lights are placed.
void drawSteps(const AccuracyOptions& options) {
  const fs::path folder = reportFolder(options.output, "out/figure-1.3", {"figure.csv"});
  Study study(options, options.launch.scene, {.size = "320x180", .set = asInPaper1()});
  const RunPlan plan = upTo(study, options, 1);
  std::vector<Variant> variants;
  for (const char* technique : {"ir", "tcas", "mir", "smc"})
    variants.push_back(study.variant(technique, {}, technique));
  const std::vector<Measured> runs = run(variants, plan, "drawing", options.output.quiet);
  const std::vector<Column> columns{
      {{"technique", "technique"}, variantName},
      {{"step", "step of a pixel over the mean", "%.2f %%", 100}, meanStep},
      {{"step_rms", "root of its square", "%.2f %%", 100},
       [](const Outcome& o) -> Value { return imageError(o.run.before[0], o.run.image).rmseShare(); }},
      {{"mean_step", "of the mean", "%+.2f %%", 100},
       [](const Outcome& o) -> Value { return -imageError(o.run.before[0], o.run.image).bias; }}};
  for (const Measured& m : runs) {
    const std::string name = (folder / m.variant.name).string();
    writePicture(name + ".png", m.image, m.exposure);
    writeShown(name + "-step.png",
               absoluteDifference(shownImage(m.image, m.exposure), shownImage(m.before[0], m.exposure), 8));
    if (&m == &runs.front() || &m == &runs.back()) // lights for all of the scene, and for what is seen of it
      writeShown(name + "-overhead.png", overhead(m.variant, plan.view(plan.frames - 1)));
  }
  const Value rows = study.rows(columns, runs);
  writeText(folder / "figure.csv", csvText(rows));
  study.report(columns, rows);
  if (!options.output.quiet) std::printf("pictures (steps times 8): %s\n", folder.c_str());
}

/// Fig. 5: three frames in which light comes into sight, with candidates resampled by what they bring and without.
void drawResampling(const AccuracyOptions& options) {
  constexpr int kFrames = 3;
  const fs::path folder = reportFolder(options.output, "out/figure-1.5", {"figure.csv"});
  Study study(options, options.launch.scene, {.size = "320x180", .set = asInPaper1()});
  const RunPlan plan = upTo(study, options, kFrames - 1);
  const std::vector<Variant> variants{study.variant("resampled", {{"smc.candidateRays", "16"}}, "smc"),
                                      study.variant("as-drawn", {{"smc.candidateRays", "1"}}, "smc")};
  std::vector<Measured> runs = run(variants, plan, "drawing", options.output.quiet);
  const std::vector<Column> columns{
      {{"candidates", "candidates"}, variantName}, {{"frame", "frame", "%g"}}, kBias, kRmseShare};
  Value rows;
  for (int i = 0; i < kFrames; ++i) {
    const int frame = plan.frames - kFrames + i;
    study.trace(256, ReferenceBuffer::Indirect, false, {}, frame);
    const auto write = [&](const std::string& name, const Image& image) {
      writePicture((folder / (name + format("-%d.png", frame))).string(), image, runs[0].exposure);
    };
    write("path-tracing", study.truth);
    for (const Measured& m : runs) {
      Measured one = m;
      if (i + 1 < kFrames) one.image = m.before[size_t(i)];
      write(m.variant.name, one.image);
      rows.add(study.row(columns, one))["frame"] = frame;
    }
  }
  writeText(folder / "figure.csv", csvText(rows));
  study.report(columns, rows);
  if (!options.output.quiet) std::printf("pictures: %s\n", folder.c_str());
}

} // namespace

std::vector<std::string> pathFigureNames() { return {"1.3", "1.5", "1.8", "1.9", "1.10", "5.5"}; }

void pathFigure(const AccuracyOptions& options) {
  if (options.figure == "1.3") return drawSteps(options);
  if (options.figure == "1.5") return drawResampling(options);
  drawPathFigure(options, options.figure);
}

} // namespace lambent
