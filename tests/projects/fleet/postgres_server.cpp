#include "tests/projects/fleet/postgres_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <pwd.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

namespace seamwright {
namespace {

namespace fs = std::filesystem;

int free_port() {
    const int s = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    int port = 0;
    if (::bind(s, reinterpret_cast<sockaddr*>(&at), size) == 0 &&
        ::getsockname(s, reinterpret_cast<sockaddr*>(&at), &size) == 0)
        port = ntohs(at.sin_port);
    ::close(s);
    return port;
}

// For a shell.
std::string quoted(const std::string& word) {
    std::string out = "'";
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

}  // namespace

std::string PostgresServer::run(const std::string& command, int& status) const {
    std::string out;
    FILE* pipe = ::popen(("cd / && " + as_user_ + command + " 2>&1 </dev/null").c_str(), "r");
    if (!pipe) return "popen failed";
    std::array<char, 4096> buffer{};
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
        out.append(buffer.data(), n);
    status = ::pclose(pipe);
    return out;
}

std::unique_ptr<PostgresServer> PostgresServer::start(std::string& why) {
    std::unique_ptr<PostgresServer> server(new PostgresServer);
    std::error_code code;
    for (const auto& version : fs::directory_iterator("/usr/lib/postgresql", code))
        if (fs::exists(version.path() / "bin/initdb", code))
            server->programs_ = (version.path() / "bin/").string();
    if (server->programs_.empty()) {
        why = "no PostgreSQL server is installed";
        return nullptr;
    }
    std::array<char, 64> name{"/tmp/seamwright-pg-XXXXXX"};
    if (!::mkdtemp(name.data())) {
        why = "no temporary folder";
        return nullptr;
    }
    server->folder_ = name.data();
    if (::geteuid() == 0) {  // it refuses to run as root
        const passwd* user = ::getpwnam("postgres");
        if (!user || ::chown(name.data(), user->pw_uid, user->pw_gid) != 0) {
            why = "there is no user postgres to run the server as";
            return nullptr;
        }
        server->as_user_ = "setpriv --reuid=postgres --regid=postgres --clear-groups ";
    }
    server->port_ = free_port();
    const std::string word_file = server->folder_ + "/word";
    std::ofstream(word_file) << kPassword << "\n";
    fs::permissions(word_file, fs::perms::all, code);
    int status = 0;
    const std::string made =
        server->run(fmt::format("{}initdb -D {}/data -U {} --pwfile={} --auth-local=trust "
                                "--auth-host=scram-sha-256 -E UTF8 --locale=C "
                                "--no-sync",
                                server->programs_, server->folder_, kUser, word_file),
                    status);
    if (status != 0) {
        why = "initdb: " + made;
        return nullptr;
    }
    if (!server->resume()) {
        why = "the server does not start";
        return nullptr;
    }
    server->ask("CREATE DATABASE fleet", "postgres");
    return server;
}

PostgresServer::~PostgresServer() {
    if (folder_.empty()) return;
    stop();
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

std::string PostgresServer::uri(const std::string& database, const std::string& password) const {
    return fmt::format("postgresql://{}{}{}@127.0.0.1:{}/{}", kUser, password.empty() ? "" : ":", password,
                       port_, database);
}

std::string PostgresServer::ask(const std::string& sql, const std::string& database) const {
    int status = 0;
    std::string out = run(fmt::format("psql -X -A -t -q -v ON_ERROR_STOP=1 -h {} -p {} -U {} -d {} -c {}",
                                      folder_, port_, kUser, database, quoted(sql)),
                          status);
    EXPECT_EQ(status, 0) << sql << "\n" << out;
    while (!out.empty() && out.back() == '\n') out.pop_back();
    return out;
}

void PostgresServer::kill() {
    std::ifstream file(folder_ + "/data/postmaster.pid");
    pid_t main = 0;
    file >> main;
    if (main <= 1) return;
    // Its children go with it, each by its number: those whose parent it is.
    std::vector<pid_t> all{main};
    std::error_code code;
    for (const auto& entry : fs::directory_iterator("/proc", code)) {
        std::ifstream stat(entry.path() / "stat");
        std::string line;
        std::getline(stat, line);
        const auto end = line.rfind(") ");
        if (end == std::string::npos) continue;
        if (std::atoi(line.c_str() + end + 4) == main) all.push_back(std::atoi(line.c_str()));
    }
    for (const pid_t pid : all) ::kill(pid, SIGKILL);
}

void PostgresServer::stop() {
    int status = 0;
    run(fmt::format("{}pg_ctl -D {}/data -m immediate -w stop", programs_, folder_), status);
}

bool PostgresServer::resume() {
    for (int attempt = 0; attempt < 50; ++attempt) {
        int status = 0;
        // Killed ones leave their shared memory for a moment.
        run(fmt::format("{}pg_ctl -D {}/data -w -l {}/log -o {} start", programs_, folder_, folder_,
                        quoted(fmt::format(
                            "-p {} -k {} -c listen_addresses=127.0.0.1 -c fsync=off -c max_connections=20",
                            port_, folder_))),
            status);
        if (status == 0) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
}

}  // namespace seamwright
