// What a scene's file may read: its own folder and what is below.
#include "engine/scene/file_access.h"

#include "tests/cpu/scene/support.h"

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include <sys/stat.h>

namespace lambent::test::file_access_test {

using nlohmann::json;

/// A scene reads its own folder and what is below, whatever the address says and wherever links lead. What is elsewhere
/// is as if it were not there: the message is the same, whether there is anything or not.
TEST(FileAccess, FilesOutsideOfTheFoldersAreNotThere) {
  const TemporaryFolder folder;
  const fs::path inside = folder / "scene", secret = folder / "secret.bin";
  fs::create_directories(inside / "sub");
  const std::string data(36, '\0');
  writeBytes(inside / "own.bin", data);
  writeBytes(inside / "sub/own.bin", data);
  writeBytes(inside / "a b+c.bin", data);
  fs::create_symlink("sub/own.bin", inside / "inner");
  fs::create_symlink("../secret.bin", inside / "link");
  fs::create_symlink(secret, inside / "absolute");
  fs::create_symlink("..", inside / "up");
  fs::create_symlink("../../secret.bin", inside / "sub/link");
  fs::create_symlink("self", inside / "self");
  ASSERT_EQ(mkfifo((inside / "fifo").c_str(), 0600), 0);
  json j = json::parse(oneTriangle().text());
  ASSERT_EQ(j["buffers"][0]["byteLength"], data.size());
  const auto file = inside / "scene.gltf";
  const auto messageFor = [&](const std::string& uri, FileTrust trust = {}) {
    j["buffers"][0]["uri"] = uri;
    writeBytes(file, j.dump(-1, ' ', false, json::error_handler_t::replace));
    try {
      loadScene(file, "", {}, trust);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  for (const char* good : {"own.bin", "./own.bin", "sub/own.bin", "sub/../own.bin", "sub/.././sub//own.bin", "inner",
                           "%6fwn.bin", "sub%2fown.bin", "a%20b+c.bin", "a b%2Bc.bin", "../scene/own.bin"})
    EXPECT_EQ(messageFor(good), "") << good;

  const std::string root = folder.path().string();
  std::vector<std::string> evil{"link",
                                "absolute",
                                "up/secret.bin",
                                "sub/link",
                                "self",
                                "fifo",
                                "sub",
                                ".",
                                "..",
                                "/",
                                "/dev/zero",
                                "/dev/stdin",
                                "/dev/fd/0",
                                "/proc/self/environ",
                                "/proc/self/cwd/secret.bin",
                                "/etc/passwd",
                                "~/secret.bin",
                                "$HOME",
                                "$(cat ../secret.bin)",
                                "`cat ../secret.bin`",
                                "*",
                                "?ink",
                                "{own,secret}.bin",
                                "own.bin/",
                                "own.bin/..",
                                "own.bin/../../secret.bin",
                                "own.bin%00.png",
                                "%00",
                                "../secret.bin%00own.bin",
                                "sub/up/secret.bin",
                                "inner/../../secret.bin",
                                "http://localhost/secret.bin",
                                "https://localhost/",
                                "ftp://localhost/secret.bin",
                                "\\\\host\\secret.bin",
                                "C:\\secret.bin",
                                "..\\secret.bin",
                                "secret.bin",
                                "tests/support/files.h",
                                "CMakeLists.txt",
                                "build.ninja",
                                std::string(5000, 'a'),
                                std::string("a/") + std::string(300, 'b'),
                                std::string(2000, '/') + "secret.bin"};
  for (const std::string way :
       {"../", "./../", "sub/../../", "sub/./../../", "..//", "up/", "./up/", "up/scene/../", "up/scene/up/",
        "sub/../up/", "../scene/../", "../scene/up/", ".././", "//", "///", "/./"})
    for (const std::string scheme : {"", "file:", "file://", "file:///"})
      evil.push_back(scheme + (way[0] == '/' ? way + root.substr(1) + "/" : way) + "secret.bin");
  const size_t plain = evil.size();
  for (size_t i = 0; i < plain; ++i) { // written otherwise
    std::string dots, slashes;
    for (const char c : evil[i]) {
      dots += c == '.' ? "%2e" : std::string(1, c);
      slashes += c == '/' ? "%2F" : std::string(1, c);
    }
    evil.push_back(dots);
    evil.push_back(slashes);
  }
  ASSERT_GT(evil.size(), 100u);
  for (const std::string& uri : evil) {
    fs::remove(secret);
    const std::string without = messageFor(uri);
    writeBytes(secret, data);
    const std::string with = messageFor(uri);
    EXPECT_NE(with, "") << uri;
    EXPECT_EQ(with, without) << uri;
    EXPECT_LT(with.size(), 3000u) << "short";
  }
  EXPECT_NE(messageFor("../secret.bin").find("--allow-outside"), std::string::npos);
  for (const char* uri : {"../secret.bin", "link", "up/secret.bin"})
    EXPECT_EQ(messageFor(uri, {.outside = true}), "") << uri;
}

/// Somebody puts a link that leads outside, and a pipe that nobody writes to, into the place of a file while it is
/// read.
TEST(FileAccess, WhatIsReadIsWhatWasChecked) {
  const TemporaryFolder folder;
  const fs::path inside = folder / "scene", file = inside / "own.bin";
  fs::create_directories(inside);
  writeBytes(folder / "secret.bin", "s");
  writeBytes(inside / "plain", "p");
  std::atomic<bool> end = false;
  std::thread other([&] {
    for (int i = 0; !end; ++i) {
      const fs::path next = inside / "next";
      if (i % 3 == 0) fs::create_symlink("../secret.bin", next);
      if (i % 3 == 1) fs::copy_file(inside / "plain", next);
      if (i % 3 == 2) {
        EXPECT_EQ(mkfifo(next.c_str(), 0600), 0);
      }
      fs::rename(next, file);
      if (i % 3 == 1) std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  });
  int read = 0, refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const HeldFile held(inside, file, false);
    if (!held) {
      ++refused;
      continue;
    }
    ++read;
    if (const int first = std::ifstream(held.opened()).get(); first != 'p') {
      ADD_FAILURE() << "read " << first;
      break;
    }
  }
  end = true;
  other.join();
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 20);
}

} // namespace lambent::test::file_access_test
