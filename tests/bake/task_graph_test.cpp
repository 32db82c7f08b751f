// Synthetic graphs: order, reuse, failure and cancel do what the contract of the task graph says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <numeric>
#include <thread>

#include "precompute/bake/executor.h"

namespace lightwell::bake {
namespace {
namespace fs = std::filesystem;

Bytes bytesOf(const std::string& text) { return {text.begin(), text.end()}; }
std::string textOf(const Blob& blob) { return {blob->begin(), blob->end()}; }

/// A graph of text tasks: each result is "name(inputs…)", and every run is counted.
class TextGraph {
 public:
  explicit TextGraph(const std::string& version = "1") : graph(version) {}
  TaskIndex add(const std::string& id, std::vector<TaskIndex> inputs = {}, const std::string& parameters = "") {
    return graph.add(
        {id, "phase " + id.substr(0, 1), "text", id + parameters, std::move(inputs), 1, [this, id, parameters](const TaskInputs& in) {
           ++runs;
           std::string text = id + parameters + "(";
           for (const auto& input : in.inputs) text += textOf(input) + ",";
           return bytesOf(text + ")");
         }});
  }
  TaskGraph graph;
  std::atomic<int> runs{0};
};

std::string runText(const TextGraph& text, TaskIndex goal, ResultStore& store, int threads = 2) {
  return textOf(ThreadExecutor(threads).run(text.graph, std::array{goal}, store, {}).goals[0]);
}

TEST(TaskGraph, DiamondRunsEachTaskOnce) {
  for (const int threads : {1, 2, 7}) {
    TextGraph text;
    const auto a = text.add("a"), b = text.add("b", {a}), c = text.add("c", {a}), d = text.add("d", {b, c, a});
    text.add("unneeded", {a});
    NullStore store;
    EXPECT_EQ(runText(text, d, store, threads), "d(b(a(),),c(a(),),a(),)");
    EXPECT_EQ(text.runs, 4);
  }
}

TEST(TaskGraph, SameBytesForAnyThreadCount) {
  std::vector<std::string> results;
  for (const int threads : {1, 2, 5, 16}) {
    TextGraph text;
    std::vector<TaskIndex> row;
    for (int i = 0; i < 40; ++i) row.push_back(text.add("r0." + std::to_string(i)));
    for (int depth = 1; depth < 5; ++depth) {
      std::vector<TaskIndex> next;
      for (size_t i = 0; i + 1 < row.size(); ++i)
        next.push_back(text.add(std::string("r") + std::to_string(depth) + "." + std::to_string(i), {row[i], row[i + 1]}));
      row = next;
    }
    const auto top = text.add("top", row);
    NullStore store;
    results.push_back(runText(text, top, store, threads));
  }
  for (const auto& result : results) EXPECT_EQ(result, results[0]);
}

TEST(TaskGraph, KeyDependsOnVersionKindParametersAndInputs) {
  const auto noop = [](const TaskInputs&) { return Bytes{}; };
  const auto keyOf = [&](const std::string& version, const std::string& kind, const std::string& parameters,
                         const std::string& input_parameters) {
    TaskGraph graph(version);
    const auto input = graph.add({"in", "p", "k", input_parameters, {}, 1, noop});
    return graph.task(graph.add({"out", "p", kind, parameters, {input}, 1, noop})).key;
  };
  const Key key = keyOf("1", "k", "p", "i");
  EXPECT_EQ(key, keyOf("1", "k", "p", "i"));
  EXPECT_NE(key, keyOf("2", "k", "p", "i"));
  EXPECT_NE(key, keyOf("1", "k2", "p", "i"));
  EXPECT_NE(key, keyOf("1", "k", "p2", "i"));
  EXPECT_NE(key, keyOf("1", "k", "p", "i2"));
  EXPECT_NE(keyOf("1", "kp", "", "i"), keyOf("1", "k", "p", "i")) << "pieces must not run into one another";
}

TEST(TaskGraph, RejectsBadDescriptions) {
  const auto noop = [](const TaskInputs&) { return Bytes{}; };
  TaskGraph graph("1");
  graph.add({"a", "p", "k", "", {}, 1, noop});
  EXPECT_THROW(graph.add({"a", "p", "k", "", {}, 1, noop}), std::logic_error);
  EXPECT_THROW(graph.add({"b", "p", "k", "", {7}, 1, noop}), std::logic_error);
  EXPECT_THROW(graph.add({"c", "p", "k", "", {}, 0, noop}), std::logic_error);
  EXPECT_THROW(graph.add({"d", "p", "k", "", {}, 1, nullptr}), std::logic_error);
  EXPECT_EQ(graph.size(), 1u);
}

TEST(Executor, StoreSkipsWhatIsKnownAndAllThatOnlyItNeeds) {
  MemoryStore store;
  for (int round = 0; round < 2; ++round) {
    TextGraph text;
    const auto a = text.add("a"), b = text.add("b", {a}), c = text.add("c", {b});
    const auto result = ThreadExecutor(2).run(text.graph, std::array{c}, store, {});
    EXPECT_EQ(text.runs, round == 0 ? 3 : 0);
    EXPECT_EQ(result.tasks_reused, round == 0 ? 0u : 1u);
  }
}

TEST(Executor, ChangedInputRerunsOnlyWhatDependsOnIt) {
  MemoryStore store;
  const auto bake = [&](const std::string& b_parameters) {
    TextGraph text;
    const auto a = text.add("a"), b = text.add("b", {}, b_parameters), c = text.add("c", {a}), d = text.add("d", {b}),
               e = text.add("e", {c, d});
    const std::string result = runText(text, e, store);
    return std::pair(result, int(text.runs));
  };
  EXPECT_EQ(bake("").second, 5);
  const auto [result, runs] = bake("!");
  EXPECT_EQ(runs, 3);  // b, d, e
  EXPECT_EQ(result, "e(c(a(),),d(b!(),),)");
}

TEST(Executor, FirstFailureInGraphOrderIsReported) {
  TaskGraph graph("1");
  std::vector<TaskIndex> tasks;
  for (int i = 0; i < 8; ++i)
    tasks.push_back(graph.add({std::to_string(i), "p", "k", std::to_string(i), {}, 1, [i](const TaskInputs&) -> Bytes {
                                 std::this_thread::sleep_for(std::chrono::milliseconds(20 * (8 - i)));
                                 throw std::runtime_error("task " + std::to_string(i));
                               }}));
  NullStore store;
  try {
    ThreadExecutor(8).run(graph, tasks, store, {});
    FAIL() << "must throw";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "task 0");
  }
}

TEST(Executor, ResumesAfterFailureWithoutRepeating) {
  MemoryStore store;
  int runs = 0;
  bool broken = true;
  const auto bake = [&] {
    TaskGraph graph("1");
    const auto a = graph.add({"a", "p", "a", "", {}, 1, [&](const TaskInputs&) { return ++runs, bytesOf("a"); }});
    const auto b = graph.add({"b", "p", "b", "", {a}, 1, [&](const TaskInputs& in) {
                                if (broken) throw std::runtime_error("broken");
                                return bytesOf(textOf(in.inputs[0]) + "b");
                              }});
    return textOf(ThreadExecutor(1).run(graph, std::array{b}, store, {}).goals[0]);
  };
  EXPECT_THROW(bake(), std::runtime_error);
  broken = false;
  EXPECT_EQ(bake(), "ab");
  EXPECT_EQ(runs, 1);
}

TEST(Executor, CancelEndsWithinASecond) {
  TaskGraph graph("1");
  std::vector<TaskIndex> tasks;
  for (int i = 0; i < 1000; ++i)
    tasks.push_back(graph.add({std::to_string(i), "p", "k", std::to_string(i), {}, 1, [](const TaskInputs& in) {
                                 for (int j = 0; j < 100; ++j)
                                   in.cancel.check(), std::this_thread::sleep_for(std::chrono::milliseconds(10));
                                 return Bytes{};
                               }}));
  NullStore store;
  CancelFlag cancel;
  std::thread canceller([&] { std::this_thread::sleep_for(std::chrono::milliseconds(100)), cancel.cancel(); });
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THROW(ThreadExecutor(3).run(graph, tasks, store, {.cancel = &cancel}), Cancelled);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  canceller.join();
}

TEST(Executor, ProgressReachesTheWhole) {
  TextGraph text;
  std::vector<TaskIndex> row;
  for (int i = 0; i < 20; ++i) row.push_back(text.add(std::to_string(i)));
  const auto top = text.add("top", row);
  std::vector<Progress> seen;
  NullStore store;
  const auto result =
      ThreadExecutor(2).run(text.graph, std::array{top}, store, {.progress = [&](const Progress& p) { seen.push_back(p); }});
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.back().tasks_done, 21u);
  EXPECT_EQ(seen.back().tasks_total, 21u);
  EXPECT_DOUBLE_EQ(seen.back().fraction, 1);
  EXPECT_EQ(result.tasks_run, 21u);
}

TEST(Executor, PhaseSecondsSumToTheWall) {
  TaskGraph graph("1");
  const auto nap = [](const TaskInputs&) { return std::this_thread::sleep_for(std::chrono::milliseconds(60)), Bytes{}; };
  std::vector<TaskIndex> tasks;
  for (int i = 0; i < 4; ++i) tasks.push_back(graph.add({std::to_string(i), i % 2 ? "odd" : "even", "k", std::to_string(i), {}, 1, nap}));
  NullStore store;
  const auto begin = std::chrono::steady_clock::now();
  const auto result = ThreadExecutor(2).run(graph, tasks, store, {});
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  ASSERT_EQ(result.phases.size(), 2u);
  EXPECT_EQ(result.phases[0].name, "even");
  const double sum_s = result.phases[0].seconds + result.phases[1].seconds;
  EXPECT_GE(sum_s, 0.119);
  EXPECT_LE(sum_s, wall_s);
}

class DirectoryStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "lightwell-store-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
  Diagnostics diagnostics_;
  const Key key_{0x0123456789abcdefull, 42};
};

TEST_F(DirectoryStoreTest, KeepsResultsBetweenProcesses) {
  EXPECT_EQ(DirectoryStore(folder_, diagnostics_).get(key_), nullptr);
  DirectoryStore(folder_, diagnostics_).put(key_, std::make_shared<Bytes>(bytesOf("result")));
  const Blob found = DirectoryStore(folder_, diagnostics_).get(key_);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(textOf(found), "result");
  EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));
}

TEST_F(DirectoryStoreTest, IgnoresEveryDamage) {
  DirectoryStore store(folder_, diagnostics_);
  store.put(key_, std::make_shared<Bytes>(bytesOf("result")));
  const fs::path file = store.fileOf(key_);
  std::ifstream in(file, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] ^= 4;
    std::ofstream(file, std::ios::binary) << damaged;
    EXPECT_EQ(store.get(key_), nullptr) << "byte " << i;
    std::ofstream(file, std::ios::binary) << whole.substr(0, i);
    EXPECT_EQ(store.get(key_), nullptr) << "cut at " << i;
  }
  store.put(key_, std::make_shared<Bytes>(bytesOf("result")));
  EXPECT_NE(store.get(key_), nullptr) << "a damaged file is rewritten";
}

TEST_F(DirectoryStoreTest, FolderThatCannotBeMadeIsAUsageError) {
  std::ofstream(folder_ / "file") << "x";
  EXPECT_THROW(DirectoryStore(folder_ / "file" / "cache", diagnostics_), UsageError);
}

TEST_F(DirectoryStoreTest, FailureToWriteWarnsOnce) {
  DirectoryStore store(folder_, diagnostics_);
  fs::remove_all(folder_ / "tmp");
  store.put(key_, std::make_shared<Bytes>(bytesOf("result")));
  store.put({1, 2}, std::make_shared<Bytes>(bytesOf("other")));
  EXPECT_EQ(diagnostics_.warnings().size(), 1u);
}

}  // namespace
}  // namespace lightwell::bake
