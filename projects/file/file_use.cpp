#include "projects/file/file_use.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace seamwright {
namespace {

std::string holder_line() {
    char host[256] = {}, since[64] = {};
    ::gethostname(host, sizeof host - 1);
    const std::time_t now = std::time(nullptr);
    std::tm local{};
    ::localtime_r(&now, &local);
    std::strftime(since, sizeof since, "%Y-%m-%d %H:%M", &local);
    return fmt::format("{}, process {} on {}, since {}", program_invocation_short_name, ::getpid(), host,
                       since);
}

// As holder_line() writes it: NAME, process NUMBER on HOST, since DATE.
bool is_holder(std::string_view line) {
    const auto parts = [&](std::string_view before) {  // what stands before, and takes it off
        const std::size_t at = line.find(before);
        const std::string_view part = line.substr(0, at);
        line.remove_prefix(at == line.npos ? line.size() : at + before.size());
        return at == line.npos ? std::string_view("\n") : part;
    };
    const std::string_view name = parts(", process "), number = parts(" on "), host = parts(", since ");
    const auto only = [](std::string_view text, std::string_view of) {
        return !text.empty() && text.find_first_not_of(of) == text.npos;
    };
    return !name.empty() && name.find_first_of(",\n") == name.npos && only(number, "0123456789") &&
           host.find_first_of(",\n") == host.npos && only(line, "0123456789-: ");
}

// What stands in a lock file of ours; nullopt: the file is somebody's who keeps something else in it.
std::optional<std::string> read_holder(int fd) {
    char text[512];
    const auto length = ::pread(fd, text, sizeof text, 0);
    if (length == 0) return "another program";  // which has just made it, or had no room on the disk
    if (length < 0) return std::nullopt;
    std::string line(text, static_cast<std::size_t>(length));
    if (!is_holder(line)) return std::nullopt;
    return line;
}

// A regular file with one name: whoever plants a link where the lock comes to stand has us write to what it
// leads to.
bool is_plain(int fd) {
    struct stat info {};
    return ::fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && info.st_nlink <= 1;
}

// Whether the name still leads to the file that is locked: its last holder may have taken it away meanwhile.
bool is_named(int fd, const std::filesystem::path& path) {
    struct stat by_fd {
    }, by_name{};
    return ::fstat(fd, &by_fd) == 0 && ::lstat(path.c_str(), &by_name) == 0 &&
           by_fd.st_ino == by_name.st_ino && by_fd.st_dev == by_name.st_dev;
}

}  // namespace

Expected<FileUse> FileUse::take(const std::filesystem::path& file, For what) {
    std::error_code unknown;
    std::filesystem::path real = std::filesystem::weakly_canonical(file, unknown);
    if (unknown) real = file;
    const std::filesystem::path lock = real.string() + (what == For::desk ? ".lock" : ".devices.lock");
    const auto not_ours = [&] {
        return file_error("where the lock of the project belongs stands something else", lock.string(),
                          "move it away");
    };
    constexpr int kTries = 100;  // each lost to a holder that went in that instant
    for (int i = 0; i < kTries; ++i) {
        // Without waiting for whoever reads a FIFO.
        const int fd = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
        if (fd < 0 && (errno == ELOOP || errno == EISDIR || errno == ENXIO)) return not_ours();
        if (fd < 0) break;
        const bool held = ::flock(fd, LOCK_EX | LOCK_NB) != 0;
        const int code = errno;
        if (!held && !is_named(fd, lock)) {
            ::close(fd);
            continue;
        }
        const auto holder = is_plain(fd) ? read_holder(fd) : std::nullopt;
        if (held || !holder) ::close(fd);
        if (held && code != EWOULDBLOCK) break;
        if (!held && !holder) return not_ours();
        if (held) {
            const std::string who = holder.value_or("another program");
            if (what == For::desk)
                return usage_error(Text("the project is open already ({})", who), file.string(),
                                   "go on there, or close it there first");
            return usage_error(Text("the devices of the project are in use already ({})", who), file.string(),
                               "disconnect them there, or end it, first");
        }
        const std::string line = holder_line();
        if (::ftruncate(fd, 0) != 0 || ::pwrite(fd, line.data(), line.size(), 0) < 0) {
            // A full disk: locked all the same, without a name.
        }
        return FileUse(lock, fd);
    }
    return FileUse({}, -1);
}

FileUse::FileUse(FileUse&& other) noexcept
    : lock_(std::move(other.lock_)), fd_(std::exchange(other.fd_, -1)) {}

FileUse& FileUse::operator=(FileUse&& other) noexcept {
    std::swap(lock_, other.lock_);
    std::swap(fd_, other.fd_);
    return *this;
}

FileUse::~FileUse() {
    if (fd_ < 0) return;
    ::unlink(lock_.c_str());  // while it is held: nobody else's
    ::close(fd_);
}

}  // namespace seamwright
