#include "game/truth_view.h"

#include "gi/measure/statistics.h"

#include <algorithm>
#include <cmath>

namespace lambent {

std::optional<ReferenceBuffer> referenceOf(Buffer buffer) {
  if (buffer > Buffer::Irradiance) return {};
  static_assert(int(Buffer::Indirect) == int(ReferenceBuffer::Indirect), "in the same order");
  return ReferenceBuffer(buffer);
}

double FramesSpent::typicalMs() const { return spreadOf(latestMs).median; }

void TruthView::set(TruthMode mode) {
  mode_ = mode;
  if (mode == TruthMode::Off) {
    reference_.reset();
    truth_.reset();
  } else if (!reference_) {
    reference_ = std::make_unique<LiveReference>(seed_);
  }
}

void TruthView::update(const SceneView& view, Viewer& gi, const FrameStats& stats, Buffer shown, bool wait) {
  countFrame(view, gi.settings(), stats);
  const std::optional<ReferenceBuffer> wanted = referenceOf(shown);
  if (!reference_) return;
  // Where a buffer has no truth, that of beauty goes on: a look at the normals does not cost what was traced.
  const ReferenceBuffer buffer = wanted.value_or(ReferenceBuffer::Beauty);
  if (const std::string why = reference_->follow(view, gi.settings(), buffer); !why.empty()) {
    truth_.reset();
    reason_ = why;
  }
  if (truth_ && truth_->buffer != buffer) {
    truth_.reset();
    reason_ = "another buffer is read from its samples";
  }
  if (!wanted) return;
  std::shared_ptr<const LiveTruth> news = reference_->take(wait);
  if (!news) return;
  truth_ = std::move(news);
  against_ = againstTruth(gi.read(shown), truth_->image);
  gi.takeTruth(truth_->image.mean);
}

void TruthView::countFrame(const SceneView& view, Settings settings, const FrameStats& stats) {
  settings.image = {}; // how light is shown, not what it is
  if (view.changes.any() || settings != before_) spent_ = {};
  before_ = settings;
  if (!stats.plan.on(EffectId::Redraw)) return;
  constexpr size_t kLatest = 64;
  ++spent_.drawn;
  spent_.ms += stats.wallMs;
  if (spent_.latestMs.size() == kLatest) spent_.latestMs.erase(spent_.latestMs.begin());
  spent_.latestMs.push_back(stats.wallMs);
}

double TruthView::fullErrorNow() const {
  if (fullError > 0) return double(fullError);
  const double wanted = 2 * against_.error.rmseShare();
  if (!(wanted > 0 && std::isfinite(wanted))) return 1;
  const double power = std::pow(10, std::floor(std::log10(wanted)));
  for (const double digit : {1, 2, 5})
    if (digit * power >= wanted) return digit * power;
  return 10 * power;
}

void TruthView::present(const Viewer& gi, Buffer shown, int width, int height) const {
  const bool known = truth_ && referenceOf(shown) == truth_->buffer;
  if (known && mode_ == TruthMode::Split)
    gi.presentBesideTruth(shown, divider, 0, width, height);
  else if (known && mode_ == TruthMode::Heat)
    gi.presentError(shown, float(std::max(1e-20, fullErrorNow() * against_.error.meanTruth)), 0, width, height);
  else
    gi.present(shown, 0, width, height);
}

} // namespace lambent
