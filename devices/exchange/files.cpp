#include "devices/exchange/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace seamwright {
namespace {

struct Descriptor {
    int fd = -1;
    ~Descriptor() {
        if (fd >= 0) ::close(fd);
    }
};

std::string system_message() {
    return std::strerror(errno);
}

}  // namespace

Expected<std::string> read_text_file(const std::filesystem::path& path, std::size_t limit_bytes) {
    Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    if (file.fd < 0) return file_error("cannot be opened (" + system_message() + ")", path.string());
    struct stat info {};
    if (::fstat(file.fd, &info) != 0)
        return file_error("cannot be read (" + system_message() + ")", path.string());
    if (S_ISDIR(info.st_mode)) return file_error("is a folder, not a file", path.string());
    const auto too_long = [&] {
        return file_error(fmt::format("is longer than {} MiB", limit_bytes >> 20), path.string());
    };
    if (info.st_size > 0 && static_cast<std::size_t>(info.st_size) > limit_bytes) return too_long();
    std::string text;
    std::size_t used = 0;
    text.resize(info.st_size > 0 ? static_cast<std::size_t>(info.st_size) + 1 : 65536);
    for (;;) {
        if (used == text.size()) text.resize(text.size() * 2);
        const ssize_t got = ::read(file.fd, text.data() + used, text.size() - used);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return file_error("cannot be read (" + system_message() + ")", path.string());
        if (got == 0) break;
        used += static_cast<std::size_t>(got);
        if (used > limit_bytes) return too_long();
    }
    text.resize(used);
    return text;
}

Expected<void> write_text_file(const std::filesystem::path& path, std::string_view text) {
    if (path.filename().empty()) return file_error("names no file", path.string(), "give the path of a file");
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        return file_error("is a folder, not a file", path.string());
    std::string temporary = path.string() + ".XXXXXX";
    Descriptor file{::mkstemp(temporary.data())};
    if (file.fd < 0) {
        return file_error("cannot be written (" + system_message() + ")", path.string(),
                          "check that the folder exists and is writable");
    }
    const auto fail = [&] {
        const std::string message = system_message();
        ::unlink(temporary.c_str());
        return file_error("cannot be written (" + message + ")", path.string());
    };
    std::size_t done = 0;
    while (done < text.size()) {
        const ssize_t put = ::write(file.fd, text.data() + done, text.size() - done);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return fail();
        done += static_cast<std::size_t>(put);
    }
    // mkstemp gives 0600; a file that already stood there keeps its rights, a new one gets the process's
    // usual ones.
    struct stat old {};
    mode_t mode = 0;
    if (::stat(path.c_str(), &old) == 0) {
        mode = old.st_mode & 07777;
    } else {
        const mode_t mask = ::umask(0);
        ::umask(mask);
        mode = 0666 & ~mask;
    }
    if (::fchmod(file.fd, mode) != 0 || ::fsync(file.fd) != 0) return fail();
    if (::rename(temporary.c_str(), path.c_str()) != 0) return fail();
    const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    Descriptor entry{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (entry.fd >= 0)
        ::fsync(entry.fd);  // the rename itself; refused by some network file systems, which is harmless
    return {};
}

}  // namespace seamwright
