// lambent compare A B: RMSE, relative MSE, bias and largest difference of two linear pictures (design/MEASURES).
#include "engine/core/error.h"
#include "tools/lambent/commands.h"

#include <cmath>
#include <cstdio>

namespace lambent {

namespace {

Image readLinear(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension == ".exr") return readExr(file);
  if (extension == ".pfm") return readPfm(file);
  throw InputError(file, "not a linear picture (.exr or .pfm)");
}

void compare(const std::string& a, const std::string& b, const OutputOptions& output) {
  const Image x = readLinear(a), y = readLinear(b);
  if (x.width != y.width || x.height != y.height)
    throw InputError(b, std::to_string(y.width) + "x" + std::to_string(y.height) + ", while " + a + " is " +
                            std::to_string(x.width) + "x" + std::to_string(x.height) + " (sizes must agree)");
  double squares = 0, relative = 0, difference = 0, sum = 0, largest = 0;
  size_t count = 0, notFinite = 0;
  for (size_t i = 0; i < x.pixels.size(); ++i) {
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
  const double n = double(std::max<size_t>(count, 1));
  const double rmse = std::sqrt(squares / n), relMse = relative / n, bias = sum != 0 ? difference / sum : 0;
  writeJson(output.json, {{"rmse", rmse},
                          {"rel_mse", relMse},
                          {"bias", bias},
                          {"max", largest},
                          {"mean_b", sum / n},
                          {"not_finite_pixels", notFinite}});
  if (output.quiet) return;
  std::printf("RMSE    %.6g\nrelMSE  %.6g\nbias    %+.3f %%   mean(A-B)/mean(B)\nmax     %.6g\nmean B  %.6g\n", rmse,
              relMse, 100 * bias, largest, sum / n);
  if (notFinite) std::printf("%zu pixels with NaN or infinity left out\n", notFinite);
}

} // namespace

void declareCompare(CLI::App& app) {
  auto files = std::make_shared<std::pair<std::string, std::string>>();
  auto output = std::make_shared<OutputOptions>();
  CLI::App* command = app.add_subcommand("compare", "errors of picture A against B (linear .exr or .pfm)");
  command->add_option("A", files->first, "picture to judge")->required();
  command->add_option("B", files->second, "picture to hold it to")->required();
  addOutputOptions(*command, *output, "");
  command->callback([files, output] { compare(files->first, files->second, *output); });
}

} // namespace lambent
