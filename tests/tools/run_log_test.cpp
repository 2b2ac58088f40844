// Runs that were measured are there again, and nothing else is.
#include "tools/kept/run_log.h"

#include "tests/support/files.h"

namespace lambent::test::run_log_test {

class RunLogTest : public testing::Test {
 protected:
  size_t runsOf(const std::string& text) const {
    writeBytes(file_, text);
    return RunLog(file_, "these").runs().size();
  }

  TemporaryFolder folder_;
  const fs::path file_ = folder_ / "runs.jsonl";
};

TEST_F(RunLogTest, KeepsRunsOfTheSameConditions) {
  for (const char* conditions : {"these", "others", "these"}) {
    RunLog log(file_, conditions);
    log.add("first", Value::of("ms", 0.1, "list", Value::list().add(1)));
    log.add("second", Value::of("ms", 1e-3));
  }
  const RunLog log(file_, "these");
  ASSERT_EQ(log.runs().size(), 4u);
  EXPECT_TRUE(log.has("first") && log.has("second") && !log.has("third"));
  EXPECT_EQ(log.runs()[0]["ms"].number(), 0.1);
  EXPECT_EQ(log.runs()[3]["session"].whole(), 3);
}

TEST_F(RunLogTest, LeavesOutWhatWasCutOrChanged) {
  const std::string line = lineOf(Value::of("key", "a", "conditions", "these", "session", 1, "ms", 2.5));
  EXPECT_EQ(runsOf(line + "\n\n" + line + "\n"), 2u);
  for (size_t n = 0; n < line.size(); ++n) EXPECT_EQ(runsOf(line.substr(0, n) + "\n" + line + "\n"), 1u) << n;
  std::string changed = line;
  changed[changed.find("2.5")] = '3';
  EXPECT_EQ(runsOf(changed), 0u);
  for (const char* text : {"[]", "17", "null", R"({"conditions":"these"})", R"({"key":"a","conditions":"these"})"})
    EXPECT_EQ(runsOf(text), 0u) << text;
  EXPECT_EQ(runsOf(lineOf(Value::of("conditions", "these"))), 0u) << "no key";
  EXPECT_EQ(runsOf(lineOf(Value::of("key", 1, "conditions", "these", "session", 1e300))), 1u);
  RunLog(file_, "these").add("b", Value::of()); // its session can be counted
}

} // namespace lambent::test::run_log_test
