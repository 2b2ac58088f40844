// lambent compare A B: RMSE, relative MSE, bias and largest difference of two linear pictures.
#include "engine/core/error.h"
#include "gi/measure/picture_error.h"
#include "tools/lambent/commands.h"
#include "tools/lambent/picture.h"

#include <cstdio>

namespace lambent {

namespace {

struct CompareOptions {
  OutputOptions output;
  std::string a, b, layer, mask, difference;
};

std::string sizeText(const Image& image) { return std::to_string(image.width) + "x" + std::to_string(image.height); }

void checkSize(const std::string& file, const Image& image, const std::string& like, const Image& wanted) {
  if (image.width != wanted.width || image.height != wanted.height)
    throw InputError(file, sizeText(image) + ", while " + like + " is " + sizeText(wanted) + " (sizes must agree)");
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
  const PictureError e = pictureError(x, y, mask);
  if (e.pixels == 0 && e.notFinite == 0) throw InputError(options.mask, "leaves no pixel (those above 0 count)");
  if (!options.difference.empty()) {
    Image difference = absoluteDifference(x, y);
    for (size_t i = 0; i < mask.pixels.size(); ++i)
      if (!(maxComponent(mask.pixels[i]) > 0)) difference.pixels[i] = vec3(0);
    writePicture(options.difference, difference, midGreyAt(e.meanTruth));
  }
  writeJson(options.output.json, Value::of({{"rmse", e.rmse},
                                            {"rel_mse", e.relMse},
                                            {"bias", e.bias},
                                            {"max", e.largest},
                                            {"mean_b", e.meanTruth},
                                            {"pixels", e.pixels},
                                            {"not_finite_pixels", e.notFinite}}));
  const auto refuse = [&] { // figures of the others are right, but this is no picture to be content with
    if (e.notFinite > 0)
      throw RunError(options.a + " or " + options.b + ": " + std::to_string(e.notFinite) +
                     " pixels are NaN or infinite");
  };
  if (options.output.quiet || e.pixels == 0) return refuse();
  std::printf("RMSE    %.6g\nrelMSE  %.6g\nbias    %+.3f %%   mean(A-B)/mean(B)\nmax     %.6g\nmean B  %.6g\n", e.rmse,
              e.relMse, 100 * e.bias, e.largest, e.meanTruth);
  if (e.notFinite > 0) std::printf("%zu pixels with NaN or infinity left out\n", e.notFinite);
  refuse();
}

} // namespace

void declareCompare(CLI::App& app) {
  auto options = std::make_shared<CompareOptions>();
  Command command(app, "compare", "errors of picture A against B (linear .exr or .pfm)");
  command.scene(options->a, "A", "picture to judge");
  command.scene(options->b, "B", "picture to hold it to");
  command.text("--layer", options->layer, "layer of B to take, where it is an .exr with several");
  command.text("--mask", options->mask, "compare only pixels where this picture (.exr or .pfm) is above 0");
  command.text("--difference", options->difference, "write |A-B|, linear .exr or .png (mean of B is mid grey)");
  command.output(options->output, "");
  command.run([options] { compare(*options); });
}

} // namespace lambent
