// fuzz [TARGET...] [--runs N] [--seed S] [--seeds FOLDER]: targets.h with mutations of its seeds, without libFuzzer,
// the same for the same numbers: what tests run. A finding ends the program, so do more than kSeconds of one input and
// more than kMost of memory; its input is fuzz-TARGET in the current folder, and `fuzz TARGET --input FILE` runs that
// alone. --seeds writes the seeds, as a corpus to begin with.
#include "engine/core/error.h"
#include "engine/core/rng.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/targets.h"

#include <sys/resource.h>
#include <sys/time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace lambent::fuzz {

namespace {

constexpr int kSeconds = 60; // of all threads together
constexpr long kMost = 2048; // MiB, under sanitizers too

class Mutator {
 public:
  Mutator(const Target& target, uint32_t seed) : target_(target), pool_(target.seeds()), rng_(seed, Stream::Test, 0) {
    for (const std::string& bytes : pool_) longest_ = std::max(longest_, 2 * bytes.size());
  }

  std::string next() {
    std::string bytes = pool_[below(pool_.size())];
    for (size_t times = 1 + below(1 + below(6)); times > 0; --times) mutate(bytes);
    return bytes;
  }
  /// Builds on what a reader took: what it refuses says nothing of what is behind.
  void keep(const std::string& bytes) {
    if (pool_.size() < 64)
      pool_.push_back(bytes);
    else
      pool_[8 + below(56)] = bytes;
  }

 private:
  size_t below(size_t n) { return rng_.below(uint32_t(n)); }

  void mutate(std::string& bytes) {
    if (bytes.empty()) bytes = "x";
    const size_t at = below(bytes.size()), length = std::min(bytes.size() - at, 1 + below(16));
    switch (below(9)) {
    case 0:
      bytes[at] = char(below(256));
      break;
    case 1:
      bytes[at] = char(bytes[at] ^ (1 << below(8)));
      break;
    case 2:
      bytes.erase(at, length);
      break;
    case 3:
      bytes.insert(at, bytes.substr(below(bytes.size()), length));
      break;
    case 4:
      if (!target_.words.empty()) bytes.replace(at, below(length + 1), target_.words[below(target_.words.size())]);
      break;
    case 5: { // another number in the place of one
      size_t digit = bytes.find_first_of("0123456789", at);
      if (digit == std::string::npos) break;
      const size_t end = std::min(bytes.find_first_not_of("0123456789.eE+-", digit), bytes.size());
      constexpr const char* numbers[] = {
          "0",    "-1",    "1",   "255",    "65536", "2147483648", "18446744073709551616",
          "1e39", "1e-46", "0.1", "-1e308", "1e-308"};
      bytes.replace(digit, end - digit, numbers[below(std::size(numbers))]);
      break;
    }
    case 6: { // a word over what is there, where a number of so many bytes may lie
      if (target_.words.empty()) break;
      const std::string& word = target_.words[below(target_.words.size())];
      bytes.replace(at / 4 * 4, word.size(), word);
      break;
    }
    case 7: { // a value of JSON in the place of one
      const auto [begin, end] = valueFrom(bytes, at);
      const auto [other, otherEnd] = valueFrom(bytes, below(bytes.size()));
      const bool word = !target_.words.empty() && below(2) == 0;
      bytes.replace(begin, end - begin,
                    word ? target_.words[below(target_.words.size())] : bytes.substr(other, otherEnd - other));
      break;
    }
    default: { // the end of another
      const std::string& other = pool_[below(pool_.size())];
      if (!other.empty()) bytes = bytes.substr(0, at) + other.substr(below(other.size()));
    }
    }
    if (bytes.size() > longest_) bytes.resize(longest_);
  }

  /// Where the next value of a list or object begins and ends.
  static std::pair<size_t, size_t> valueFrom(const std::string& text, size_t at) {
    const size_t begin = std::min(text.find_first_of(":,[", at), text.size() - 1) + 1;
    size_t end = begin;
    for (int depth = 0; end < text.size(); ++end) {
      const char c = text[end];
      if (c == '"') end = std::min(text.find('"', end + 1), text.size() - 1);
      if (c == '[' || c == '{') ++depth;
      if (depth == 0 && (c == ',' || c == ']' || c == '}')) break;
      if (c == ']' || c == '}') --depth;
    }
    return {begin, end};
  }

  const Target& target_;
  std::vector<std::string> pool_;
  size_t longest_ = 1 << 12; // bytes: of short ones more can be tried
  Rng rng_;
};

/// Ends the program where a run does not end, or takes memory without bounds.
bool runBounded(const Target& target, const std::string& bytes) {
  const itimerval limit{{}, {kSeconds, 0}};
  setitimer(ITIMER_PROF, &limit, nullptr);
  const bool taken = target.run(bytes);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  CHECK_LT(usage.ru_maxrss >> 10, kMost);
  return taken;
}

void run(const Target& target, long runs, uint32_t seed) {
  const auto begin = std::chrono::steady_clock::now();
  Mutator mutator(target, seed);
  const std::string found = std::string("fuzz-") + target.name;
  for (const std::vector<std::string>& all : {target.seeds(), target.probes})
    for (const std::string& bytes : all) {
      writeBytes(found, bytes); // there when it ends the program
      runBounded(target, bytes);
    }
  long taken = 0;
  for (long i = 0; i < runs; ++i) {
    const std::string bytes = mutator.next();
    writeBytes(found, bytes);
    if (!runBounded(target, bytes)) continue;
    ++taken;
    mutator.keep(bytes);
  }
  std::filesystem::remove(found);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::printf("%s: %ld runs (%ld taken), seed %u, %.1f s, nothing found\n", target.name, runs, taken, seed, seconds);
}

int runAll(int argc, char** argv) {
  long runs = 2000;
  uint32_t seed = 1;
  std::string input, seeds;
  std::vector<const Target*> chosen;
  for (int i = 1; i < argc; ++i) {
    const bool more = i + 1 < argc;
    if (more && !std::strcmp(argv[i], "--runs"))
      runs = std::atol(argv[++i]);
    else if (more && !std::strcmp(argv[i], "--seed"))
      seed = uint32_t(std::atol(argv[++i]));
    else if (more && !std::strcmp(argv[i], "--input"))
      input = argv[++i];
    else if (more && !std::strcmp(argv[i], "--seeds"))
      seeds = argv[++i];
    else {
      const auto found =
          std::ranges::find_if(targets(), [&](const Target& t) { return !std::strcmp(t.name, argv[i]); });
      if (found == targets().end()) return std::fprintf(stderr, "error: no target %s\n", argv[i]), 2;
      chosen.push_back(&*found);
    }
  }
  if (chosen.empty())
    for (const Target& t : targets()) chosen.push_back(&t);
  for (const Target* t : chosen) {
    if (!seeds.empty()) {
      std::filesystem::create_directories(std::filesystem::path(seeds) / t->name);
      int n = 0;
      for (const std::string& bytes : t->seeds())
        writeBytes(std::filesystem::path(seeds) / t->name / std::to_string(n++), bytes);
    } else if (!input.empty()) {
      t->run(readBytes(input));
    } else {
      run(*t, runs, seed);
    }
  }
  return 0;
}

} // namespace
} // namespace lambent::fuzz

int main(int argc, char** argv) { return lambent::fuzz::runAll(argc, argv); }
