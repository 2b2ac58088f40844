#include "engine/core/files.h"

#include "engine/core/error.h"
#include "engine/core/interrupt.h"

#include <cerrno>
#include <chrono>
#include <climits>
#include <fstream>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lambent {

namespace fs = std::filesystem;

namespace {
/// A temporary's name fits in 255 bytes where the target's does.
struct TemporaryName {
  std::string begin, end;
  explicit TemporaryName(const fs::path& file)
      : begin("." + file.stem().string().substr(0, 100) + ".lambent-"), end(file.extension().string()) {
    constexpr size_t kLongestEnd = 32; // no format's
    if (end.size() > kLongestEnd) end.clear();
  }
};

bool isTemporaryOf(const std::string& name, const fs::path& file) {
  const auto [begin, end] = TemporaryName(file);
  if (name.size() <= begin.size() + end.size() || !name.starts_with(begin) || !name.ends_with(end)) return false;
  const std::string between = name.substr(begin.size(), name.size() - begin.size() - end.size());
  return between.find_first_not_of("0123456789") == between.npos;
}

/// Made by this program alone, and locked while it lives: a lock that can be had is that of a program that was killed.
class Temporary {
 public:
  Temporary(const fs::path& temporary, const fs::path& file)
      : file_(open(temporary.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666)) {
    if (file_ < 0) throw RunError(file.string() + ": cannot be written: " + std::generic_category().message(errno));
    flock(file_, LOCK_EX | LOCK_NB); // where the disk knows no locks it is as one that was left
    struct stat replaced {};
    if (stat(file.c_str(), &replaced) == 0) fchmod(file_, (replaced.st_mode & 0777) | S_IRUSR | S_IWUSR);
  }
  ~Temporary() { close(file_); }
  Temporary(const Temporary&) = delete;

 private:
  int file_;
};

/// Whether nobody writes it any more. Where the disk knows no locks: `otherwise`.
bool abandoned(const fs::path& temporary, bool otherwise) {
  const int file = open(temporary.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return false;
  const bool free = flock(file, LOCK_EX | LOCK_NB) == 0 || (errno != EWOULDBLOCK && otherwise);
  close(file);
  return free;
}

fs::path folderOf(const fs::path& file) { return file.parent_path().empty() ? "." : file.parent_path(); }

/// A file's or folder's, without links. By place, not by what lies there: a rename leaves what else leads to that
/// alone.
fs::path placeOf(const fs::path& file) {
  std::error_code none;
  return fs::weakly_canonical(fs::absolute(file, none), none);
}

/// Places of files or folders, for all of the program.
class Places {
 public:
  void add(const fs::path& file) {
    const std::lock_guard lock(mutex_);
    places_.insert(placeOf(file));
    places_.erase(fs::path()); // one that cannot be looked at
  }
  bool hold(const fs::path& file) {
    const std::lock_guard lock(mutex_);
    return !places_.empty() && places_.contains(placeOf(file));
  }
  /// Whether it lies in one of them, or below.
  bool areAbove(const fs::path& file) {
    const std::lock_guard lock(mutex_);
    if (places_.empty()) return false;
    for (fs::path at = placeOf(folderOf(file)); at.has_relative_path(); at = at.parent_path())
      if (places_.contains(at)) return true;
    return false;
  }

 private:
  std::mutex mutex_;
  std::set<fs::path> places_;
};

/// See keepFromReplacing.
Places& keptFiles() {
  static Places files;
  return files;
}

/// See refuseLinksIn.
Places& foldersWithoutLinks() {
  static Places folders;
  return folders;
}

/// Throws InputError where a file of a folder of results would be written through a link.
void refuseLinks(const fs::path& named) {
  std::error_code none;
  for (fs::path at = named; at.has_filename(); at = at.parent_path())
    if (fs::is_symlink(at, none) && foldersWithoutLinks().areAbove(at))
      throw InputError(named.string(), "is not written: " + (at == named ? "it" : at.string()) +
                                           " is a link (remove it, or name another folder)");
}

/// What this program wrote into folders whose other files it does not replace.
class OwnResults {
 public:
  static constexpr const char* kList = ".lambent-results";

  void begin(const fs::path& folder) {
    const std::lock_guard lock(mutex_);
    names_[placeOf(folder)] = listed(folder);
  }

  /// Whether the folder is one of these, and holds a file by that name that is not in its list.
  bool wouldLose(const fs::path& file) {
    std::error_code none;
    const std::lock_guard lock(mutex_);
    if (names_.empty() || !fs::exists(fs::symlink_status(file, none))) return false;
    const auto found = names_.find(placeOf(folderOf(file)));
    const std::string name = file.filename().string();
    if (found == names_.end() || found->second.contains(name)) return false;
    found->second.merge(listed(folderOf(file))); // another program writes here too
    return !found->second.contains(name);
  }

  /// In one piece, so that two programs may list theirs at once.
  void add(const fs::path& file) {
    const std::lock_guard lock(mutex_);
    const std::string name = file.filename().string();
    if (names_.empty() || name.find('\n') != name.npos) return;
    const auto found = names_.find(placeOf(folderOf(file)));
    if (found == names_.end() || !found->second.insert(name).second) return;
    const fs::path list = folderOf(file) / kList;
    const int descriptor =
        open(list.c_str(), O_CREAT | O_WRONLY | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    const Unbroken whole;
    try {
      if (descriptor < 0) throw std::system_error(errno, std::generic_category());
      appendAll(descriptor, "\n" + name); // not behind half a line
    } catch (const std::system_error& e) {
      if (descriptor >= 0) close(descriptor);
      found->second.erase(name);
      throw RunError(list.string() + ": cannot be written: " + e.code().message());
    }
    close(descriptor);
  }

 private:
  static std::set<std::string> listed(const fs::path& folder) {
    const fs::path list = folder / kList;
    std::error_code none;
    const fs::file_status status = fs::symlink_status(list, none);
    if (fs::exists(status) && !fs::is_regular_file(status)) throw InputError(list.string(), "is not a file");
    std::ifstream in(list);
    std::set<std::string> names;
    for (std::string line; std::getline(in, line);)
      if (!line.empty() && line.size() <= NAME_MAX) names.insert(line);
    return names;
  }

  std::mutex mutex_;
  std::map<fs::path, std::set<std::string>> names_;
};

/// See replaceOnlyOwnIn.
OwnResults& ownResults() {
  static OwnResults results;
  return results;
}

/// Keeps a pipe open for as long as the program runs, so that its reader is not at its end before something is written.
/// Waits for a reader for a second; throws RunError where there is none by then.
void holdPipe(const fs::path& file) {
  static std::mutex mutex;
  static std::set<fs::path> held;
  const std::lock_guard lock(mutex);
  if (held.contains(file)) return;
  for (int tries = 0; tries < 50; ++tries) {
    if (open(file.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC) >= 0) {
      held.insert(file);
      return;
    }
    if (errno != ENXIO)
      throw RunError(file.string() + ": cannot be written: " + std::generic_category().message(errno));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  throw RunError(file.string() + ": cannot be written: nobody reads this pipe (start its reader before)");
}

} // namespace

void makeFolder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw RunError(folder.string() + ": cannot make this folder (" + failure.message() + ")");
}

void checkWritable(const fs::path& named) {
  std::error_code none;
  refuseLinks(named);
  if (named.filename() == OwnResults::kList) throw InputError(named.string(), "is not replaced: it lists results");
  if (ownResults().wouldLose(named))
    throw InputError(named.string(), "is not replaced: no result that was written here (name another folder)");
  const fs::path file = leadsTo(named);
  const fs::path folder = folderOf(file);
  const auto refuse = [&](const std::string& why) { throw RunError(named.string() + ": cannot be written: " + why); };
  if (file.filename().string().size() > NAME_MAX)
    refuse("its name is longer than " + std::to_string(NAME_MAX) + " bytes");
  if (!fs::is_directory(folder, none)) refuse("there is no folder " + folder.string());
  if (fs::is_directory(file, none)) refuse("it is a folder");
  if (keptFiles().hold(file))
    throw InputError(named.string(), "is not replaced: it is read, or another result (name another folder or file)");
  if (fs::is_fifo(file, none)) holdPipe(file);
  if (fs::exists(file, none) && !fs::is_regular_file(file, none)) return; // a device or a pipe
  if (access(folder.c_str(), W_OK | X_OK) != 0) refuse("the folder " + folder.string() + " is not writable");
}

bool sameFile(const fs::path& a, const fs::path& b) {
  std::error_code none;
  if (fs::exists(a, none) && fs::exists(b, none)) return fs::is_regular_file(a, none) && fs::equivalent(a, b, none);
  const auto there = [&](const fs::path& file) {
    return fs::weakly_canonical(fs::absolute(leadsTo(file), none), none);
  };
  return !a.empty() && !b.empty() && !there(a).empty() && there(a) == there(b);
}

void keepFromReplacing(const fs::path& file) { keptFiles().add(file); }

void refuseLinksIn(const fs::path& folder) { foldersWithoutLinks().add(folder); }

void replaceOnlyOwnIn(const fs::path& folder) {
  refuseLinksIn(folder);
  ownResults().begin(folder);
}

void listAsOwn(const fs::path& file) { ownResults().add(file); }

fs::path leadsTo(fs::path file) {
  constexpr int kMostLinks = 40; // as Linux follows
  std::error_code none;
  if (fs::exists(file, none)) {
    const fs::path there = fs::canonical(file, none); // has none where it is a pipe of the shell's
    return there.empty() ? file : there;
  }
  const std::string named = file.string();
  for (int i = 0; fs::is_symlink(file, none); ++i) {
    if (i == kMostLinks) throw RunError(named + ": cannot be written: its links lead to one another");
    file = file.parent_path() / fs::read_symlink(file, none);
  }
  return file;
}

namespace {

/// Removes what programs that were killed have left of a file, as removeLeftovers. A folder is looked through once: it
/// may hold a film of 10^5 frames, and what another program leaves there later can wait.
void removeLeftoversOnce(const fs::path& file) {
  static std::mutex mutex;
  static std::map<fs::path, std::vector<fs::path>> hidden; // names that begin with a dot, by folder
  const std::lock_guard lock(mutex);
  const auto [found, first] = hidden.try_emplace(placeOf(folderOf(file)));
  std::error_code ignored;
  for (fs::directory_iterator at(folderOf(file), ignored), end; first && at != end; at.increment(ignored))
    if (const fs::path name = at->path().filename(); name.string().starts_with('.')) found->second.push_back(name);
  for (const fs::path& name : found->second)
    if (isTemporaryOf(name.string(), file) && abandoned(folderOf(file) / name, false))
      fs::remove(folderOf(file) / name, ignored);
}

} // namespace

void writeAtomically(const fs::path& named, const std::function<void(const fs::path&)>& write) {
  std::error_code ignored;
  checkWritable(named);
  const fs::path file = foldersWithoutLinks().areAbove(named) ? named : leadsTo(named);
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored))
    return write(file); // a device or a pipe: nothing to keep, and a rename would put a file in its place
  removeLeftoversOnce(file);
  // The random part keeps two programs that write the same target apart; the extension stays last because some
  // encoders choose their format by it.
  const fs::path temporary = temporaryFor(file);
  const Unbroken whole;
  const Temporary held(temporary, file);
  try {
    write(temporary);
    listAsOwn(file); // before it is there: a kill between them loses nothing
    fs::rename(temporary, file);
  } catch (const fs::filesystem_error& e) {
    fs::remove(temporary, ignored);
    throw RunError(file.string() + ": cannot be written: " + e.code().message());
  } catch (...) {
    fs::remove(temporary, ignored);
    throw;
  }
}

void writeAtomically(const fs::path& file, std::string_view bytes) {
  writeAtomically(file, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), std::streamsize(bytes.size()));
    out.close();
    if (!out) throw RunError(file.string() + ": cannot be written (is the folder writable, the disk full?)");
  });
}

FolderLock::FolderLock(const fs::path& folder, bool inTurn)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  constexpr int kTries = 500, kMost = 5000; // since the folder last changed, and of a queue
  struct stat before {};
  for (int tries = 0, all = 0; tries < kTries && all < kMost; ++tries, ++all) {
    if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    struct stat now {};
    fstat(descriptor_, &now);
    const bool changed = now.st_mtim.tv_sec != before.st_mtim.tv_sec || now.st_mtim.tv_nsec != before.st_mtim.tv_nsec;
    if (inTurn && changed) tries = 0, before = now;
  }
  held_ = false;
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

AppendedFile::AppendedFile(const fs::path& file)
    : file_(file), descriptor_(open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_APPEND | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0)
    throw RunError(file.string() + ": cannot be written: " +
                   (errno == EEXIST ? "it is there already (name another)" : std::generic_category().message(errno)));
  flock(descriptor_, LOCK_EX); // waits for who looks whether it was left
}

AppendedFile::~AppendedFile() { close(descriptor_); }

void AppendedFile::append(std::string_view line) {
  const off_t before = lseek(descriptor_, 0, SEEK_END);
  const Unbroken whole;
  try {
    appendAll(descriptor_, line);
  } catch (const std::system_error& e) {
    const bool back = ftruncate(descriptor_, before) == 0;
    throw RunError(file_.string() + ": cannot be written: " + e.code().message() +
                   (back ? "" : " (its last line is torn)"));
  }
}

bool withUnheld(const fs::path& file, const std::function<bool(int)>& with) {
  const int descriptor = open(file.c_str(), O_RDWR | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return false;
  bool done = false;
  try {
    done = flock(descriptor, LOCK_EX | LOCK_NB) == 0 && with(descriptor);
  } catch (...) {
    close(descriptor);
    throw;
  }
  close(descriptor);
  return done;
}

void appendAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = write(descriptor, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw std::system_error(errno, std::generic_category());
    bytes.remove_prefix(size_t(n));
  }
}

fs::path temporaryFor(const fs::path& file) {
  const TemporaryName name(file);
  return file.parent_path() / (name.begin + std::to_string(std::random_device{}()) + name.end);
}

void removeLeftovers(const fs::path& named) {
  const fs::path file = leadsTo(named);
  std::error_code ignored;
  for (const fs::directory_entry& e : fs::directory_iterator(folderOf(file), ignored))
    if (isTemporaryOf(e.path().filename().string(), file) && abandoned(e.path(), true)) fs::remove(e.path(), ignored);
}

} // namespace lambent
