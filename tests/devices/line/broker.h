#pragma once
// Debian's mosquitto as a child on a free port, which may be killed and started again on the same one, and what
// mosquitto_sub hears there.

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "devices/net/socket.h"
#include "tests/devices/line/wait.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {

// A child that does not outlive this object.
class Child {
  public:
    Child(const std::vector<std::string>& words, const std::filesystem::path& out) {
        pid_ = ::fork();
        if (pid_ != 0) return;
        if (!std::freopen(out.c_str(), "a", stdout) || !std::freopen(out.c_str(), "a", stderr)) ::_exit(126);
        std::vector<char*> arguments;
        for (const std::string& w : words) arguments.push_back(const_cast<char*>(w.c_str()));
        arguments.push_back(nullptr);
        ::execv(arguments[0], arguments.data());
        ::_exit(127);
    }
    ~Child() { end(SIGKILL); }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    void signal(int number) const { ::kill(pid_, number); }
    void end(int number) {
        if (pid_ <= 0) return;
        ::kill(pid_, number);
        ::waitpid(std::exchange(pid_, 0), nullptr, 0);
    }
    bool runs() const { return pid_ > 0 && ::waitpid(pid_, nullptr, WNOHANG) == 0; }

  private:
    pid_t pid_ = 0;
};

class Broker {
  public:
    explicit Broker(std::string more = "allow_anonymous true\n") : more_(std::move(more)) {
        for (int i = 0; i < 20; ++i) {
            const std::uint16_t free = TcpListener::listen("127.0.0.1", 0)->port();
            if (start(free)) return;
        }
        ADD_FAILURE() << "no broker";
    }
    // False: the port was taken meanwhile.
    bool start(std::uint16_t on) {
        port_ = on;
        const auto file = folder_.path() / "mosquitto.conf";
        std::ofstream(file) << "listener " << port_ << " 127.0.0.1\npersistence false\nuser root\n" << more_;
        child_ = std::make_unique<Child>(std::vector<std::string>{MOSQUITTO_BROKER, "-c", file.string()},
                                         folder_.path() / "mosquitto.log");
        return soon([&] {
                   return !child_->runs() ||
                          TcpConnection::connect("127.0.0.1", port_, std::chrono::milliseconds(100));
               }) &&
               child_->runs();
    }
    void kill() { child_.reset(); }
    bool again() { return start(port_); }
    void freeze() const { child_->signal(SIGSTOP); }
    void reread() const { child_->signal(SIGHUP); }  // its passwords
    void thaw() const { child_->signal(SIGCONT); }
    std::uint16_t port() const { return port_; }
    std::filesystem::path folder() const { return folder_.path(); }
    std::string sub(const std::string& arguments) const {
        return shell(std::string(MOSQUITTO_SUB) + " -h 127.0.0.1 -p " + std::to_string(port_) + " " +
                     arguments)
            .text;
    }
    Said pub(const std::string& arguments) const {
        return shell(std::string(MOSQUITTO_PUB) + " -h 127.0.0.1 -p " + std::to_string(port_) + " -q 1 " +
                     arguments);
    }

  private:
    TemporaryFolder folder_;
    std::string more_;
    std::uint16_t port_ = 0;
    std::unique_ptr<Child> child_;
};

}  // namespace seamwright
