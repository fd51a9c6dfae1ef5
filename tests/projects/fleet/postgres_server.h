#pragma once
// A PostgreSQL server of a test's own: made by initdb in a folder of its own, on a free loopback port, gone with the object.

#include <memory>
#include <string>

namespace seamwright {

class PostgresServer {
  public:
    // nullptr: no server is installed, or this user may start none; `why` says which.
    static std::unique_ptr<PostgresServer> start(std::string& why);
    ~PostgresServer();

    static constexpr const char* kUser = "seam";
    static constexpr const char* kPassword = "p@ss:w/rd'\\ 1";  // every sign that may go wrong
    static constexpr const char* kPasswordInUri = "p%40ss%3Aw%2Frd%27%5C%201";

    // With the password, of a database of that name.
    std::string uri(const std::string& database = "fleet",
                    const std::string& password = kPasswordInUri) const;
    int port() const { return port_; }
    // As the superuser, without going through Seamwright. What psql prints, unaligned; FAILs where it fails.
    std::string ask(const std::string& sql, const std::string& database = "fleet") const;

    void kill();    // -9, the main process and its children
    void stop();    // at once, as "pg_ctl stop -m immediate"
    bool resume();  // after either; recovers by its log

  private:
    PostgresServer() = default;
    std::string run(const std::string& command, int& status) const;
    std::string folder_, programs_, as_user_;
    int port_ = 0;
};

}  // namespace seamwright
