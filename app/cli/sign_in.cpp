#include "app/cli/sign_in.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include "core/system_text.h"

namespace seamwright::cli {
namespace {

struct SignInArguments {
    std::string user, password_file;
    std::string password;  // asked for once
};
// Of the one command that this process runs.
SignInArguments& given() {
    static SignInArguments of_the_command;
    return of_the_command;
}

class Descriptor {
  public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }

  private:
    int fd_;
};

constexpr std::size_t kLongestLine = 1024;

// Until the line's end; what it ends with is not part of it.
std::string read_line(int fd) {
    std::string line;
    char c = 0;
    while (line.size() <= kLongestLine) {
        const auto count = ::read(fd, &c, 1);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0 || c == '\n') break;
        line += c;
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
}

Expected<std::string> from_file(const std::string& path) {
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat info {};
    if (file.get() < 0 || ::fstat(file.get(), &info) != 0)
        return file_error(Text("the password's file cannot be read ({})", system_text(errno)), path);
    if (S_ISREG(info.st_mode) && (info.st_mode & (S_IRWXG | S_IRWXO)) != 0)
        return input_error("others may read the password's file", path, Text("chmod 600 {}", path));
    std::string line = read_line(file.get());
    if (line.empty()) return input_error("the password's file begins with no password", path);
    return line;
}

Expected<std::string> from_terminal(const std::string& asked) {
    const Descriptor terminal(::open("/dev/tty", O_RDWR | O_CLOEXEC));
    termios as_it_was{};
    if (terminal.get() < 0 || ::tcgetattr(terminal.get(), &as_it_was) != 0)
        return usage_error("no terminal asks for the password", {},
                           "give --password-file FILE or the environment's SEAMWRIGHT_PASSWORD");
    termios silent = as_it_was;
    silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    const std::string question = asked + ": ";
    (void)!::write(terminal.get(), question.data(), question.size());
    ::tcsetattr(terminal.get(), TCSAFLUSH, &silent);
    std::string line = read_line(terminal.get());
    ::tcsetattr(terminal.get(), TCSAFLUSH, &as_it_was);
    (void)!::write(terminal.get(), "\n", 1);
    return line;
}

Expected<void> sign_in_to(ProjectFile& file) {
    if (given().user.empty()) {
        if (!given().password_file.empty())
            return usage_error("a password without its user", given().password_file, "give --user NAME");
        return {};
    }
    SEAM_TRY(const auto users, file.users());
    if (users.empty())
        return usage_error("the project has no users", file.path().string(),
                           "leave --user out, or add one: seamwright user add");
    SEAM_OK(check_user_name(given().user));
    if (given().password.empty()) {
        SEAM_TRY(given().password, read_password({given().password_file, "SEAMWRIGHT_PASSWORD",
                                                  "Password of " + given().user}));
    }
    SEAM_OK(file.sign_in(given().user, given().password));
    return {};
}

}  // namespace

void add_sign_in(CLI::App* command) {
    command->add_option("--user", given().user, "Who works, in a project with users")->type_name("NAME");
    command
        ->add_option("--password-file", given().password_file,
                     "His password is the first line; else SEAMWRIGHT_PASSWORD, else the terminal asks")
        ->type_name("FILE");
}

Expected<std::string> read_password(const PasswordSource& source) {
    if (!source.file.empty()) return from_file(source.file);
    if (const char* set = std::getenv(source.environment); set && *set) return std::string(set);
    SEAM_TRY(auto typed, from_terminal(source.asked));
    if (source.twice) {
        SEAM_TRY(const auto again, from_terminal(source.asked + " (again)"));
        if (again != typed) return usage_error("the two passwords differ", {}, "try again");
    }
    return typed;
}

Expected<ProjectFile> open_to_edit(const std::string& path) {
    SEAM_TRY(auto file, ProjectFile::open(path));
    SEAM_OK(sign_in_to(file));
    return file;
}

Expected<Station> open_station(const std::string& path, std::optional<Deed> deed) {
    SEAM_TRY(auto station, Station::open(path));
    SEAM_OK(sign_in_to(station.file()));
    if (deed) SEAM_OK(station.file().may(*deed));
    return station;
}

}  // namespace seamwright::cli
