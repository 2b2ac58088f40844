// Files that are written whole or not at all: to a temporary name next to the target, which is then renamed.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace lambent {

/// Makes a folder and those above it where they are missing. Throws RunError.
void makeFolder(const std::filesystem::path& folder);

/// Checks before long work that a file can be written. Throws RunError where it cannot: no such folder, one that is not
/// writable, a folder by its name, a pipe that nobody reads within a second; InputError where it is kept, a link in a
/// folder of results, or somebody's (replaceOnlyOwnIn). A pipe stays open until the program ends, or its reader would
/// be at its end before.
void checkWritable(const std::filesystem::path& file);

/// Whether two names are of one file, or would be once it is written.
bool sameFile(const std::filesystem::path& a, const std::filesystem::path& b);

/// Has checkWritable refuse to replace this file for the rest of the program: it is read, or is a result already. The
/// files of a report have many names, and none of them may cost a scene its texture. Any thread.
void keepFromReplacing(const std::filesystem::path& file);

/// Has checkWritable refuse what is written through a link that lies in this folder or below: names of what goes there
/// are the program's, and nobody meant what they lead to. Any thread.
void refuseLinksIn(const std::filesystem::path& folder);

/// The same, and has it refuse to replace what lies in this folder and is not in its list of what this program wrote
/// there, .lambent-results, a name a line (none that has a line break). Throws InputError where that is no file. Any
/// thread.
void replaceOnlyOwnIn(const std::filesystem::path& folder);
/// Takes a file into that list before it is written by another way than writeAtomically; nothing in other folders.
/// Throws RunError.
void listAsOwn(const std::filesystem::path& file);

/// What a link leads to, whether it is there or not; of other files that are there the place without links. Throws
/// RunError for links that lead to one another.
std::filesystem::path leadsTo(std::filesystem::path file);

/// Calls write(temporary), lists `file` as listAsOwn() does and renames the temporary to it; removes it and rethrows on
/// failure. Throws as checkWritable() does.
void writeAtomically(const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& write);
/// The same for a file of these bytes.
void writeAtomically(const std::filesystem::path& file, std::string_view bytes);

/// Keeps others who ask for it out of a folder while it lives. Waits a second for them, and then no longer: a program
/// that is stopped holds nobody up. Of some that write `inTurn` it waits until nothing in the folder has changed for a
/// second, ten at most. Nothing where the disk knows no locks.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder, bool inTurn = false);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;

  /// False where somebody else kept it for all of that time.
  bool held() const { return held_; }

 private:
  int descriptor_;
  bool held_ = true;
};

/// A new file that grows line by line: whatever ends the program, it has all lines before. Locked while it lives, where
/// the disk knows locks.
class AppendedFile {
 public:
  /// Throws RunError, also where there is one by that name.
  explicit AppendedFile(const std::filesystem::path& file);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;

  /// Throws RunError where the disk is full: the file then is as it was.
  void append(std::string_view line);

 private:
  const std::filesystem::path file_;
  int descriptor_ = -1;
};

/// Calls with(descriptor) for a file that no AppendedFile holds, while none can; returns what that does, else false.
bool withUnheld(const std::filesystem::path& file, const std::function<bool(int)>& with);
/// Appends all bytes. Throws std::system_error.
void appendAll(int descriptor, std::string_view bytes);

/// A name beside `file` for what is to take its place. removeLeftovers finds it.
std::filesystem::path temporaryFor(const std::filesystem::path& file);

/// Removes temporaries of `file` left by programs that were killed while they wrote. What another one writes stays.
void removeLeftovers(const std::filesystem::path& file);

} // namespace lambent
