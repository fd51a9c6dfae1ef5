#include "devices/exchange/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>

#include "core/system_text.h"

namespace seamwright {
namespace {

struct Descriptor {
    int fd = -1;
    ~Descriptor() {
        if (fd >= 0) ::close(fd);
    }
};

// errno says why not.
bool write_all(int fd, std::string_view text) {
    while (!text.empty()) {
        const ssize_t put = ::write(fd, text.data(), text.size());
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) return false;
        text.remove_prefix(static_cast<std::size_t>(put));
    }
    return true;
}

// The number of the descriptor of this process that a name like /dev/stdout or /dev/fd/3 means.
std::optional<int> own_descriptor(const std::filesystem::path& path) {
    std::filesystem::path at = path;
    for (int i = 0; i < 8; ++i) {
        std::error_code code;
        const auto folder = std::filesystem::canonical(
            at.has_parent_path() ? at.parent_path() : std::filesystem::path("."), code);
        int number = 0;
        const std::string name = at.filename().string();
        const auto [end, problem] = std::from_chars(name.data(), name.data() + name.size(), number);
        if (!code && folder == fmt::format("/proc/{}/fd", ::getpid()) && problem == std::errc() &&
            end == name.data() + name.size())
            return number;
        const auto next = std::filesystem::read_symlink(at, code);
        if (code) return std::nullopt;
        at = next.is_absolute() ? next : at.parent_path() / next;
    }
    return std::nullopt;
}

}  // namespace

Expected<std::string> read_text_file(const std::filesystem::path& path, std::size_t limit_bytes) {
    Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    if (file.fd < 0) return file_error(Text("cannot be opened ({})", system_text(errno)), path.string());
    struct stat info {};
    if (::fstat(file.fd, &info) != 0)
        return file_error(Text("cannot be read ({})", system_text(errno)), path.string());
    if (S_ISDIR(info.st_mode)) return file_error("is a folder, not a file", path.string());
    const auto too_long = [&] {
        return file_error(Text("is longer than {} MiB", limit_bytes >> 20), path.string());
    };
    if (info.st_size > 0 && static_cast<std::size_t>(info.st_size) > limit_bytes) return too_long();
    std::string text;
    std::size_t used = 0;
    text.resize(info.st_size > 0 ? static_cast<std::size_t>(info.st_size) + 1 : 65536);
    for (;;) {
        if (used == text.size()) text.resize(text.size() * 2);
        const ssize_t got = ::read(file.fd, text.data() + used, text.size() - used);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return file_error(Text("cannot be read ({})", system_text(errno)), path.string());
        if (got == 0) break;
        used += static_cast<std::size_t>(got);
        if (used > limit_bytes) return too_long();
    }
    text.resize(used);
    return text;
}

std::filesystem::path behind_links(const std::filesystem::path& path) {
    constexpr int kMostLinks = 40;  // as the kernel
    std::filesystem::path at = path;
    for (int i = 0; i < kMostLinks; ++i) {
        std::error_code code;
        const auto next = std::filesystem::read_symlink(at, code);
        if (code) return at;
        at = next.is_absolute() ? next : at.parent_path() / next;
    }
    return at;
}

Expected<void> check_replaceable(const std::filesystem::path& path) {
    constexpr char kDatabase[] = "SQLite format 3";  // with its 0
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return {};
    Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    char begin[sizeof kDatabase];
    if (file.fd < 0 || ::read(file.fd, begin, sizeof begin) != static_cast<ssize_t>(sizeof begin)) return {};
    if (std::memcmp(begin, kDatabase, sizeof begin) != 0) return {};
    return input_error("is a project or a recording, which nothing else may replace", path.string(),
                       "give the name of another file");
}

Expected<void> write_text_file(const std::filesystem::path& path, std::string_view text) {
    if (path.filename().empty()) return file_error("names no file", path.string(), "give the path of a file");
    if (path.native().starts_with("--"))
        return input_error("is an option, not the name of a file", path.string(),
                           "give a name, or ./ before one that begins like that");
    const auto failed = [&](const Text& message) {
        return file_error(Text("cannot be written ({})", message), path.string());
    };
    struct stat old {};
    const bool exists = ::stat(path.c_str(), &old) == 0;
    if (!exists && errno == ELOOP) return failed(system_text(errno));
    if (exists && S_ISDIR(old.st_mode)) return file_error("is a folder, not a file", path.string());
    if (const auto own = own_descriptor(path)) {
        // Not opened anew: that would write at the start of a file that the shell has written to.
        if (!write_all(*own, text)) return failed(system_text(errno));
        return {};
    }
    if (exists && !S_ISREG(old.st_mode)) {
        Descriptor through{::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY)};
        if (through.fd < 0 || !write_all(through.fd, text)) return failed(system_text(errno));
        return {};
    }
    SEAM_OK(check_replaceable(path));
    const std::filesystem::path target = behind_links(path);
    std::string temporary = target.string() + ".XXXXXX";
    Descriptor file{::mkostemp(temporary.data(), O_CLOEXEC)};
    if (file.fd < 0) {
        return file_error(Text("cannot be written ({})", system_text(errno)), path.string(),
                          "check that the folder exists and is writable");
    }
    const auto fail = [&] {
        const Text message = system_text(errno);
        ::unlink(temporary.c_str());
        return failed(message);
    };
    if (!write_all(file.fd, text)) return fail();
    // mkostemp gives 0600; a file that already stood there keeps its rights, a new one gets the process's
    // usual ones.
    mode_t mode = 0;
    if (exists) {
        mode = old.st_mode & 07777;
    } else {
        const mode_t mask = ::umask(0);
        ::umask(mask);
        mode = 0666 & ~mask;
    }
    if (::fchmod(file.fd, mode) != 0 || ::fsync(file.fd) != 0) return fail();
    if (::rename(temporary.c_str(), target.c_str()) != 0) return fail();
    const auto folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
    Descriptor entry{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (entry.fd >= 0)
        ::fsync(entry.fd);  // the rename itself; refused by some network file systems, which is harmless
    return {};
}

}  // namespace seamwright
