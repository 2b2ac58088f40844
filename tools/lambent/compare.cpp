// lambent compare A B: RMSE, relative MSE, bias and largest difference of two linear pictures.
#include "engine/core/error.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/linear_picture.h"

#include <cmath>
#include <cstdio>

namespace lambent {

namespace {

struct CompareOptions {
  OutputOptions output;
  std::string a, b, layer, mask, difference;
};

void checkSize(const std::string& file, const Image& image, const std::string& like, const Image& wanted) {
  if (image.width != wanted.width || image.height != wanted.height)
    throw InputError(file, std::to_string(image.width) + "x" + std::to_string(image.height) + ", while " + like +
                               " is " + std::to_string(wanted.width) + "x" + std::to_string(wanted.height) +
                               " (sizes must agree)");
}

void compare(const CompareOptions& options) {
  if (!options.difference.empty()) checkPictureName(options.difference);
  const Image x = readLinear(options.a);
  const Image y = options.layer.empty() ? readLinear(options.b) : readExr(options.b, options.layer);
  checkSize(options.b, y, options.a, x);
  Image mask;
  if (!options.mask.empty()) {
    mask = readLinear(options.mask);
    checkSize(options.mask, mask, options.a, x);
  }
  Image absolute(x.width, x.height);
  double squares = 0, relative = 0, difference = 0, sum = 0, largest = 0;
  size_t count = 0, notFinite = 0;
  for (size_t i = 0; i < x.pixels.size(); ++i) {
    if (!mask.pixels.empty() && !(maxComponent(mask.pixels[i]) > 0)) continue;
    absolute.pixels[i] = glm::abs(x.pixels[i] - y.pixels[i]);
    if (!isFinite(x.pixels[i]) || !isFinite(y.pixels[i])) {
      ++notFinite;
      continue;
    }
    for (int c = 0; c < 3; ++c) {
      const double p = x.pixels[i][c], q = y.pixels[i][c], d = p - q;
      squares += d * d;
      relative += d * d / (q * q + 0.01);
      difference += d;
      sum += q;
      largest = std::max(largest, std::abs(d));
      ++count;
    }
  }
  if (count == 0 && notFinite == 0) throw InputError(options.mask, "leaves no pixel (those above 0 count)");
  const double n = double(std::max<size_t>(count, 1));
  const double rmse = std::sqrt(squares / n), relMse = relative / n, bias = sum != 0 ? difference / sum : 0;
  // As a display shows it, a difference of B's mean is mid grey.
  if (!options.difference.empty()) writePicture(options.difference, absolute, sum > 0 ? float(0.25 * n / sum) : 1.0f);
  writeJson(options.output.json, {{"rmse", rmse},
                                  {"rel_mse", relMse},
                                  {"bias", bias},
                                  {"max", largest},
                                  {"mean_b", sum / n},
                                  {"pixels", count / 3},
                                  {"not_finite_pixels", notFinite}});
  if (options.output.quiet) return;
  std::printf("RMSE    %.6g\nrelMSE  %.6g\nbias    %+.3f %%   mean(A-B)/mean(B)\nmax     %.6g\nmean B  %.6g\n", rmse,
              relMse, 100 * bias, largest, sum / n);
  if (notFinite) std::printf("%zu pixels with NaN or infinity left out\n", notFinite);
}

} // namespace

void declareCompare(CLI::App& app) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command = app.add_subcommand("compare", "errors of picture A against B (linear .exr or .pfm)");
  command->add_option("A", options->a, "picture to judge")->required();
  command->add_option("B", options->b, "picture to hold it to")->required();
  command->add_option("--layer", options->layer, "layer of B to take, where it is an .exr with several");
  command->add_option("--mask", options->mask, "compare only pixels where this picture (.exr or .pfm) is above 0");
  command->add_option("--difference", options->difference, "write |A-B|, linear .exr or .png (mean of B is mid grey)");
  addOutputOptions(*command, options->output, "");
  command->callback([options] { compare(*options); });
}

} // namespace lambent
